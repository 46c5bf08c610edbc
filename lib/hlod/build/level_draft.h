// One level of an HLOD while it is built. Vertices are those of the input mesh, wedges those of the WedgeMesh. Without
// seams a wedge is a vertex.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/large_vector.h"
#include "occlod/hlod/hlod.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod::hlod {

// Wedge v of a node's input ended up in u.
struct Merge {
  WedgeId v = no_id;
  WedgeId u = no_id;
};

// The splits of a node by its input's own wedge numbers, which have 16 bits.
struct SplitsDraft {
  struct Split {
    std::uint16_t v = 0, u = 0;  // v was merged into u
    float error = 0.0F;
  };
  std::vector<WedgeId> wedges;         // by own number
  std::vector<std::uint16_t> indices;  // three for each triangle that the node was made from
  std::vector<Split> splits;           // the coarsest first; none: the node has no splits, the rest is empty too
};

struct NodeDraft {
  std::uint32_t first_triangle = 0;  // into LevelDraft::triangles
  std::uint32_t triangle_count = 0;
  std::vector<std::uint32_t> children;  // places on the level below, ascending
  std::size_t first_merge = 0;          // into LevelDraft::merges
  std::size_t merge_count = 0;
  std::vector<WedgeId> bare_targets;  // wedges that others were merged into, but that no triangle uses any more
  Box box, lod_box;
  Sphere sphere;
  float error = 0.0F, child_error = 0.0F, guaranteed_error = 0.0F, area = 0.0F;
  SplitsDraft within;  // with Within::splits
};

struct LevelDraft {
  std::vector<NodeDraft> nodes;
  LargeVector<Triangle> triangles;       // vertices, node by node
  LargeVector<Triangle> corners;         // their wedges; empty without seams
  LargeVector<Merge> merges;             // node by node
  LargeVector<std::uint32_t> parent_of;  // of each triangle: the place on the next level of the node that replaces it;
                                         // empty on the last level

  [[nodiscard]] std::span<const Merge> merges_of(const NodeDraft& node) const {
    return std::span<const Merge>(merges).subspan(node.first_merge, node.merge_count);
  }
  [[nodiscard]] const LargeVector<Triangle>& wedge_triangles() const { return corners.empty() ? triangles : corners; }
  [[nodiscard]] std::span<const Triangle> triangles_of(const NodeDraft& node) const {
    return std::span<const Triangle>(triangles).subspan(node.first_triangle, node.triangle_count);
  }
};

}  // namespace occlod::hlod
