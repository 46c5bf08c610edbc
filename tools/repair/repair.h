// Makes an oriented manifold of any triangle soup, and counts what that takes.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "occlod/mesh.h"

namespace occlod::repair {

struct RepairOptions {
  double weld = 0.0;           // merge vertices no farther apart than this, object units; 0 = none
  std::size_t fill_holes = 0;  // close borders of at most so many edges; 0 = none
  // Called now and then with what is being done and, where that is known, the share done; what it throws ends the work.
  std::function<void(const std::string&, std::optional<double>)> progress;
};

// triangles after = triangles before - dropped ones + added ones.
struct RepairCounts {
  std::size_t vertices_welded = 0;
  std::size_t collapsed_dropped = 0;  // triangles of which welding made a line or a point
  std::size_t repeated_dropped = 0;   // the same corners in the same direction as an earlier triangle
  std::size_t opposite_dropped = 0;   // the same corners as an earlier triangle, in the other direction
  std::size_t zero_area_dropped = 0;  // three corners on one line, the longest side on the border
  std::size_t zero_area_flipped = 0;  // its longest side given away: the triangle beyond is cut in two there
  std::size_t zero_area_kept = 0;     // neither can be done without breaking the manifold
  std::size_t triangles_turned = 0;
  std::size_t unorientable_edges = 0;   // cut: beyond them the surface comes back turned over
  std::size_t vertices_duplicated = 0;  // at such edges, at edges of three or more triangles, between fans
  std::size_t edges_stitched = 0;       // of those cut: pairs of borders that fit together after all
  std::size_t holes_filled = 0;
  std::size_t triangles_added = 0;
  std::size_t borders_left = 0;  // closed loops of border edges

  [[nodiscard]] std::size_t dropped() const noexcept {
    return collapsed_dropped + repeated_dropped + opposite_dropped + zero_area_dropped;
  }
};

struct RepairedMesh {
  TriangleMesh mesh;  // no edge of more than two triangles, no vertex of more than one fan, one direction throughout
  RepairCounts changes;
};

// Takes what clean() gives. No vertex moves except to where another is (`weld`), none is made except as a copy, so that
// without `weld` and `fill_holes` the surface stays the same set of points but for triangles without area on borders.
// Of each piece the triangles in the minority are turned. The same mesh and options give the same result.
[[nodiscard]] RepairedMesh repair_mesh(const TriangleMesh& mesh, const RepairOptions& options = {});

}  // namespace occlod::repair
