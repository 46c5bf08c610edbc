// Numbers the distinct vertices of a small mesh in the order in which they are met.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "base/memory.h"
#include "occlod/base.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"

namespace occlod::hlod {

// What decides which collapse is next, beside how far the surface moves. With weight `boundary`, relative to the
// triangles beside them, planes hold boundary edges in place; `attributes`: how far texture coordinates, normals and
// colours slip on the surface.
struct BuildWeights {
  double boundary = 1.0;
  double attributes = 0.7;
};
inline constexpr BuildWeights build_weights;

// An open hash table. Reused, it allocates only when it has to grow.
class LocalIds {
 public:
  // Forgets all; room for so many vertices.
  void reset(std::size_t max_vertices) {
    vertices_.clear();
    const std::size_t slots = std::bit_ceil(2 * max_vertices + 2);
    mask_ = slots - 1;
    slots_.assign(slots, no_id);
  }

  // The number of v, a new one when it has none.
  std::uint32_t add(VertexId v) {
    std::uint32_t& slot = slots_[find_slot(v)];
    if (slot == no_id) {
      slot = static_cast<std::uint32_t>(vertices_.size());
      vertices_.push_back(v);
    }
    return slot;
  }
  // The number of v, or no_id.
  [[nodiscard]] std::uint32_t find(VertexId v) const { return slots_[find_slot(v)]; }
  // By number.
  [[nodiscard]] std::span<const VertexId> vertices() const { return vertices_; }

 private:
  [[nodiscard]] std::size_t find_slot(VertexId v) const {
    std::size_t slot = (v * 0x9e3779b97f4a7c15ULL >> 32U) & mask_;
    while (slots_[slot] != no_id && vertices_[slots_[slot]] != v) slot = (slot + 1) & mask_;
    return slot;
  }

  std::vector<VertexId> vertices_;
  std::vector<std::uint32_t> slots_;
  std::size_t mask_ = 0;
};

// The input of an HLOD while it is built, and the wedges that its levels add to it.

// The arrays of a TriangleMesh, which may be larger than memory. Vertices stay; wedges are added where a collapse
// stretches a chart over a vertex that had none in it.
struct WedgeMesh {
  LargeVector<glm::vec3> positions;
  LargeVector<glm::vec3> normals;
  LargeVector<glm::u8vec4> colors;
  LargeVector<glm::vec2> texture_coordinates;
  LargeVector<VertexId> extra_wedges;  // their vertices; those that were added in no order
  LargeVector<Triangle> triangles;
  LargeVector<Triangle> corners;
  LargeVector<MaterialId> wedge_materials;  // by wedge; empty when triangles name none
  std::vector<Material> materials;
  std::vector<Texture> textures;
  TextureOrigin texture_origin = TextureOrigin::bottom_left;

  [[nodiscard]] std::size_t vertex_count() const noexcept { return positions.size() - extra_wedges.size(); }
  [[nodiscard]] std::size_t wedge_count() const noexcept { return positions.size(); }
  [[nodiscard]] VertexId vertex_of(WedgeId wedge) const noexcept {
    return wedge < vertex_count() ? wedge : extra_wedges[wedge - vertex_count()];
  }
  // Whether a vertex may have several wedges.
  [[nodiscard]] bool has_seams() const noexcept { return !extra_wedges.empty(); }
  // Whether simplification takes attributes into account.
  [[nodiscard]] bool has_wedge_attributes() const noexcept { return has_seams() || !texture_coordinates.empty(); }

  // A wedge of `vertex` with the attributes and the material of `like`.
  void add(VertexId vertex, WedgeId like) {
    const auto repeat = [](auto& values, WedgeId wedge) {
      if (!values.empty()) values.push_back(typename std::decay_t<decltype(values)>::value_type(values[wedge]));
    };
    repeat(positions, vertex);
    repeat(normals, like);
    repeat(colors, like);
    repeat(texture_coordinates, like);
    repeat(wedge_materials, like);
    extra_wedges.push_back(vertex);
  }
};

// The same mesh with its vertices along a Morton curve, as in_spatial_order() has it. O(n).
[[nodiscard]] WedgeMesh to_wedge_mesh(const TriangleMesh& mesh, unsigned threads);

// One level of an HLOD while it is built. Vertices are those of the input mesh, wedges those of the WedgeMesh. Without
// seams a wedge is a vertex.

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
