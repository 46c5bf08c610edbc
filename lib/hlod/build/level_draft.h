// Holds the input and the levels of an HLOD while it is built.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "base/arithmetic.h"
#include "base/memory.h"
#include "occlod/base.h"
#include "occlod/bounds.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"

namespace occlod::hlod {

// Weights that order collapses, in addition to how far the surface moves. Planes that hold boundary edges in place have
// weight `boundary`, relative to the triangles beside them; `attributes` weighs how far texture coordinates, normals
// and colours slip on the surface.
struct BuildWeights {
  double boundary = 1.0;
  double attributes = 0.7;
};
inline constexpr BuildWeights build_weights;

// How many triangles are grouped and how many of them are left.
struct Reduction {
  std::uint32_t node_triangles = 2000;   // the most of a node of level 0
  std::uint32_t group_triangles = 8000;  // the most of a group that becomes a node of a coarser level
  double wanted_share = 0.25;            // of its triangles, that is left of a group
  double least_share = 0.125;            // of its triangles, that is kept where they are cheap to remove
  std::uint32_t sampled_groups = 32;     // of a level, from which the cost is taken at which its groups stop
  std::uint32_t smallest_patch = 62;     // smaller ones move to a neighbour
  std::uint32_t largest_group = 10'000;  // that has taken such patches in
  bool keeps_bounds = true;              // whether boxes, guaranteed errors and merges of nodes are wanted
};

// Returns what nodes of an HLOD are made with. Its largest groups have at most three times as many vertices as
// triangles, which 16 bits can number.
[[nodiscard]] constexpr Reduction hlod_reduction(std::uint32_t node_triangles) {
  return {.node_triangles = node_triangles,
          .group_triangles = 4 * node_triangles,
          .smallest_patch = node_triangles / 32,
          .largest_group = 5 * node_triangles};
}

// Numbers the distinct vertices of a small mesh in the order in which they are met. The hash table uses open addressing
// and, when reused, allocates only to grow.
class LocalIds {
 public:
  // Forgets all vertices and makes room for `max_vertices`.
  void reset(std::size_t max_vertices) {
    vertices_.clear();
    const std::size_t slots = std::bit_ceil(2 * max_vertices + 2);
    mask_ = slots - 1;
    slots_.assign(slots, no_id);
  }

  // Returns the number of v; assigns a new one if it has none.
  std::uint32_t add(VertexId v) {
    std::uint32_t& slot = slots_[find_slot(v)];
    if (slot == no_id) {
      slot = static_cast<std::uint32_t>(vertices_.size());
      vertices_.push_back(v);
    }
    return slot;
  }
  // Returns the number of v, or no_id.
  [[nodiscard]] std::uint32_t find(VertexId v) const { return slots_[find_slot(v)]; }
  // Returns the vertices, ordered by number.
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

// Describes a wedge that the simplification of a node has added: where a collapse stretches a chart over a vertex that
// had none in it, and where a vertex has moved.
struct NewWedge {
  VertexId vertex = no_id;
  WedgeId like = no_id;  // has the same attributes, material and feature
  glm::vec3 position{0.0F};
};

// Holds the arrays of a TriangleMesh, which may be larger than memory; several threads fill the larger ones. Input
// wedges never change. A vertex has one position on each level, that of its wedges there.
struct WedgeMesh {
  UninitializedVector<glm::vec3> positions;
  UninitializedVector<glm::vec3> normals;
  UninitializedVector<glm::u8vec4> colors;
  UninitializedVector<glm::vec2> texture_coordinates;
  LargeVector<VertexId> extra_wedges;  // vertex of each extra wedge; added ones are in no order
  UninitializedVector<Triangle> triangles;
  UninitializedVector<Triangle> corners;
  LargeVector<MaterialId> wedge_materials;  // per wedge; empty when triangles name none
  LargeVector<FeatureId> wedge_features;    // per wedge; empty where there are fewer than two
  std::vector<Material> materials;
  std::vector<std::string> feature_names;
  std::vector<Texture> textures;
  TextureOrigin texture_origin = TextureOrigin::bottom_left;
  float lattice_step = 0.0F;  // HlodView::lattice_step
  glm::dvec3 origin{0.0};
  UpAxis up = UpAxis::z;

  [[nodiscard]] std::size_t vertex_count() const noexcept { return positions.size() - extra_wedges.size(); }
  [[nodiscard]] std::size_t wedge_count() const noexcept { return positions.size(); }
  [[nodiscard]] VertexId vertex_of(WedgeId wedge) const noexcept {
    return wedge < vertex_count() ? wedge : extra_wedges[wedge - vertex_count()];
  }
  // Returns the material of a wedge; also 0 when triangles name none. feature_of() likewise.
  [[nodiscard]] MaterialId material_of(WedgeId wedge) const {
    return wedge_materials.empty() ? MaterialId{0} : wedge_materials[wedge];
  }
  [[nodiscard]] FeatureId feature_of(WedgeId wedge) const {
    return wedge_features.empty() ? FeatureId{0} : wedge_features[wedge];
  }
  // Returns whether a vertex may have several wedges.
  [[nodiscard]] bool has_seams() const noexcept { return !extra_wedges.empty(); }
  // Returns whether simplification takes attributes into account.
  [[nodiscard]] bool has_wedge_attributes() const noexcept {
    return has_seams() || !texture_coordinates.empty() || !normals.empty() || !colors.empty();
  }

  void add(const NewWedge& wedge) {
    const auto repeat = [](auto& values, WedgeId like) {
      if (!values.empty()) values.push_back(typename std::decay_t<decltype(values)>::value_type(values[like]));
    };
    positions.push_back(wedge.position);
    repeat(normals, wedge.like);
    repeat(colors, wedge.like);
    repeat(texture_coordinates, wedge.like);
    repeat(wedge_materials, wedge.like);
    repeat(wedge_features, wedge.like);
    extra_wedges.push_back(wedge.vertex);
  }
};

// Returns the same mesh with its vertices along a Morton curve; those of one cell are in the order in which triangles
// first use them, which a mesh that comes in pieces has too. Features get wedges of their own. O(n).
[[nodiscard]] WedgeMesh to_wedge_mesh(const TriangleMesh& mesh, unsigned threads);

// Records that wedge v of a node's input was merged, perhaps through others, into u.
struct Merge {
  WedgeId v = no_id;
  WedgeId u = no_id;
};

// Lists the splits of a node by the node's own 16-bit numbers for the wedges of its input.
struct SplitsDraft {
  struct Split {
    std::uint16_t v = 0, u = 0;  // v was merged into u
    float error = 0.0F;
  };
  std::vector<WedgeId> wedges;         // by the node's own number
  std::vector<std::uint16_t> indices;  // three per triangle that the node was made from
  std::vector<Split> splits;           // coarsest first; if there are none, the other arrays are empty too
};

// Makes the box in a list of at most one hold another one too.
inline void grow(std::vector<Box>& at_most_one, const Box& box) {
  if (at_most_one.empty())
    at_most_one = {box};
  else
    at_most_one[0] = unite(at_most_one[0], box);
}

struct NodeDraft {
  std::uint32_t first_triangle = 0;  // into LevelDraft::triangles
  std::uint32_t triangle_count = 0;
  std::vector<std::uint32_t> children;  // places on the level below, ascending
  std::size_t first_merge = 0;          // into LevelDraft::merges
  std::size_t merge_count = 0;
  std::vector<WedgeId> bare_targets;  // wedges that others were merged into, but that no triangle uses any more
  Box box, lod_box;
  std::vector<Box> vanished;  // at most one: holds what vanished here or below and no vertex of a triangle stands for
  Sphere sphere;
  float error = 0.0F, child_error = 0.0F, guaranteed_error = 0.0F, area = 0.0F;
  SplitsDraft within;  // filled with Within::splits
};

struct LevelDraft {
  std::vector<NodeDraft> nodes;
  UninitializedVector<Triangle> triangles;  // vertex ids, node by node
  UninitializedVector<Triangle> corners;    // wedges of the triangles; empty where each vertex is its own wedge
  LargeVector<Merge> merges;                // node by node
  // Holds, per triangle, the place on the next level of the node that replaces it; empty on the last level.
  UninitializedVector<std::uint32_t> parent_of;

  [[nodiscard]] std::span<const Merge> merges_of(const NodeDraft& node) const {
    return std::span<const Merge>(merges).subspan(node.first_merge, node.merge_count);
  }
  [[nodiscard]] const UninitializedVector<Triangle>& wedge_triangles() const {
    return corners.empty() ? triangles : corners;
  }
  [[nodiscard]] std::span<const Triangle> triangles_of(const NodeDraft& node) const {
    return std::span<const Triangle>(triangles).subspan(node.first_triangle, node.triangle_count);
  }
  [[nodiscard]] std::span<const Triangle> wedge_triangles_of(const NodeDraft& node) const {
    return std::span<const Triangle>(wedge_triangles()).subspan(node.first_triangle, node.triangle_count);
  }
};

}  // namespace occlod::hlod
