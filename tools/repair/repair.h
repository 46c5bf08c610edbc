// Makes an oriented manifold of any triangle soup, and counts the changes.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "occlod/mesh.h"

namespace occlod::repair {

struct RepairOptions {
  double weld = 0.0;           // merge vertices no farther apart than this, object units; 0: none
  std::size_t fill_holes = 0;  // close borders of at most this many edges; 0: none
  // Is called now and then with the current step and, if known, the share done. An exception from it ends the work.
  std::function<void(const std::string&, std::optional<double>)> progress;
};

// The triangles after the repair are those before, minus dropped ones, plus added ones.
struct RepairCounts {
  std::size_t vertices_welded = 0;
  std::size_t collapsed_dropped = 0;  // triangles that welding made a line or a point
  std::size_t repeated_dropped = 0;   // same corners in the same direction as an earlier triangle
  std::size_t opposite_dropped = 0;   // same corners as an earlier triangle, in the other direction
  std::size_t zero_area_dropped = 0;  // three corners on one line, with the longest side on the border
  std::size_t zero_area_flipped = 0;  // three corners on one line: the triangle beyond the longest side is cut
  std::size_t zero_area_kept = 0;     // neither is possible without breaking the manifold
  std::size_t triangles_turned = 0;
  std::size_t unorientable_edges = 0;   // cut: beyond them the surface returns with the other side up
  std::size_t vertices_duplicated = 0;  // at such edges, at edges of three or more triangles, and between fans
  std::size_t edges_stitched = 0;       // cut edges whose borders fit together after all
  std::size_t holes_filled = 0;
  std::size_t triangles_added = 0;
  std::size_t borders_left = 0;  // closed loops of border edges

  [[nodiscard]] std::size_t dropped() const noexcept {
    return collapsed_dropped + repeated_dropped + opposite_dropped + zero_area_dropped;
  }
};

struct RepairedMesh {
  TriangleMesh mesh;  // no edge of more than two triangles, no vertex of more than one fan, consistently oriented
  RepairCounts changes;
};

// Accepts what clean() returns. No vertex moves except to another's place (`weld`), and none is added except as a copy.
// So without `weld` and `fill_holes` the surface stays the same set of points, apart from triangles without area on
// borders. In each piece the triangles in the minority are turned. The same mesh and options give the same result.
[[nodiscard]] RepairedMesh repair_mesh(const TriangleMesh& mesh, const RepairOptions& options = {});

}  // namespace occlod::repair
