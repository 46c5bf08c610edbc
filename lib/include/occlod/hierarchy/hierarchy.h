// The recorded collapse sequence of one mesh: a multi-triangulation over one static vertex buffer (De Floriani,
// Magillo, Puppo). Built once, immutable, flat arrays, parents before children. All lengths are object units.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "occlod/core/ids.h"
#include "occlod/math/bounds.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// What refinement reads for every split it looks at: one cache line. Split s brings back vertex base_vertex_count + s.
struct SplitNode {
  Sphere sphere;       // around every face that this split or one below it in the forest removes or inserts
  NormalCone cone;     // of the normals of those faces
  float error = 0.0F;  // quadric error: root mean square distance, ordered collapses; >= that of every
                       // split that depends on this one or stands below it in the forest
  float guaranteed_error =
      0.0F;  // bound on the distance between the surface without this split and the input; saturated alike
  SplitId child_u = no_id;          // forest: the next split of the same parent vertex
  SplitId child_v = no_id;          // forest: the first split of the vertex that this one brings back
  VertexId parent_vertex = no_id;   // u, the vertex that v is split from
  std::uint32_t level = 0;          // depth in the split forest, 0 at roots
  FaceId first_inserted = 0;        // this split inserts faces [first_inserted, next node's first_inserted)
  std::uint32_t first_removed = 0;  // and removes removed_faces [first_removed, next node's first_removed)
};
static_assert(sizeof(SplitNode) == 64, "one cache line");

// The arrays of a hierarchy, as built and as stored in an .olod file.
struct HierarchyData {
  // Vertices: first those of the base mesh, then vertex base_vertex_count + s for each split s.
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;   // unit; empty when the input had none
  std::vector<glm::u8vec4> colors;  // empty when the input had none
  // Splits from coarse to fine, and one sentinel that ends the ranges of the last.
  std::vector<SplitNode> nodes;
  std::vector<SplitId> roots;                   // splits without a forest parent, ascending
  std::vector<std::uint32_t> first_dependency;  // nodes.size() entries; split s needs dependencies [s, s+1)
  std::vector<SplitId> dependencies;            // ascending for each split, all smaller than it
  // Faces: those of the base mesh, then those that split 0 inserts, split 1, ...
  std::vector<Triangle> faces;
  std::vector<SplitId> died;  // the split that removes the face; no_id for faces of the input mesh
  std::vector<FaceId> removed_faces;
  // Bounds of the same faces as SplitNode::sphere, one per split, for those who draw them as query proxies.
  std::vector<Box> boxes;
  std::vector<Cylinder> cylinders;  // along the normal of the vertex that the split brings back
};

class Hierarchy {
 public:
  Hierarchy() = default;
  // Takes arrays whose sizes and indices fit together (see check_structure in validate.h).
  explicit Hierarchy(HierarchyData data);

  [[nodiscard]] const HierarchyData& data() const noexcept { return data_; }

  [[nodiscard]] std::size_t vertex_count() const noexcept { return data_.positions.size(); }
  [[nodiscard]] std::size_t split_count() const noexcept { return data_.nodes.empty() ? 0 : data_.nodes.size() - 1; }
  [[nodiscard]] std::size_t face_count() const noexcept { return data_.faces.size(); }
  [[nodiscard]] std::size_t base_vertex_count() const noexcept { return vertex_count() - split_count(); }
  [[nodiscard]] std::size_t base_triangle_count() const noexcept {
    return data_.nodes.empty() ? 0 : data_.nodes[0].first_inserted;
  }
  [[nodiscard]] std::size_t input_triangle_count() const noexcept { return input_triangle_count_; }

  [[nodiscard]] const SplitNode& node(SplitId s) const noexcept { return data_.nodes[s]; }
  [[nodiscard]] VertexId vertex_of(SplitId s) const noexcept { return static_cast<VertexId>(base_vertex_count() + s); }
  [[nodiscard]] std::span<const glm::vec3> positions() const noexcept { return data_.positions; }
  [[nodiscard]] const Triangle& face(FaceId f) const noexcept { return data_.faces[f]; }

  // The faces that split s inserts: consecutive ids.
  [[nodiscard]] std::span<const Triangle> inserted(SplitId s) const noexcept {
    return {data_.faces.data() + data_.nodes[s].first_inserted, inserted_count(s)};
  }
  [[nodiscard]] std::size_t inserted_count(SplitId s) const noexcept {
    return data_.nodes[s + 1].first_inserted - data_.nodes[s].first_inserted;
  }
  [[nodiscard]] std::span<const FaceId> removed(SplitId s) const noexcept {
    return {data_.removed_faces.data() + data_.nodes[s].first_removed,
            data_.nodes[s + 1].first_removed - data_.nodes[s].first_removed};
  }
  [[nodiscard]] std::span<const SplitId> dependencies(SplitId s) const noexcept {
    return {data_.dependencies.data() + data_.first_dependency[s],
            data_.first_dependency[s + 1] - data_.first_dependency[s]};
  }

  // A sphere around the whole mesh, and its box.
  [[nodiscard]] const Box& box() const noexcept { return box_; }
  // The largest guaranteed error of any split: what the base mesh promises.
  [[nodiscard]] float error_bound() const noexcept { return error_bound_; }
  // Bytes that the arrays occupy.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  HierarchyData data_;
  Box box_;
  std::size_t input_triangle_count_ = 0;
  float error_bound_ = 0.0F;
};

}  // namespace occlod
