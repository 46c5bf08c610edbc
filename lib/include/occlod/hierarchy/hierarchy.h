// The recorded collapse sequence of one mesh: a multi-triangulation over one static vertex buffer (De Floriani,
// Magillo, Puppo). Built once, immutable, flat arrays, parents before children. All lengths are object units.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>

#include "occlod/core/ids.h"
#include "occlod/core/large_vector.h"
#include "occlod/hierarchy/split_guard.h"
#include "occlod/hierarchy/split_node.h"
#include "occlod/hierarchy/split_star.h"
#include "occlod/math/bounds.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// The arrays of a hierarchy. Array<T> is a vector where they are built and a span where they are read.
template <template <typename> typename Array>
struct HierarchyFields {
  // Vertices: first those of the base mesh, then vertex base_vertex_count + s for each split s.
  Array<glm::vec3> positions;
  Array<glm::vec3> normals;    // unit; empty when the input had none
  Array<glm::u8vec4> colors;   // empty when the input had none
  Array<SplitNode> nodes;      // from coarse to fine, and a sentinel that ends the last one's star
  Array<std::uint32_t> stars;  // the records of all splits in their order, see SplitStar
  Array<SplitId> roots;        // splits without a forest parent, ascending
  Array<Triangle> base_faces;
  Box box;                                 // of all positions
  std::uint64_t input_triangle_count = 0;  // when all splits are applied
  std::uint64_t face_count = 0;            // that ever existed: of the base mesh and of all stars
  float error_bound = 0.0F;                // the largest guaranteed error of any split: what the base mesh promises
};
template <typename T>
using OwnedArray = LargeVector<T>;
template <typename T>
using ReadArray = std::span<const T>;
using HierarchyData = HierarchyFields<OwnedArray>;
using HierarchyView = HierarchyFields<ReadArray>;

[[nodiscard]] HierarchyView view_of(const HierarchyData& data);

class Hierarchy {
 public:
  Hierarchy() = default;
  // Takes arrays whose sizes and indices fit together (see check_structure in validate.h).
  explicit Hierarchy(HierarchyData data);
  // Arrays that `owner` keeps alive, of which `guard` (if any) checks each part before it is used for the first time.
  Hierarchy(const HierarchyView& view, std::shared_ptr<const void> owner, std::shared_ptr<SplitGuard> guard);

  // Of a hierarchy in a mapped file only what require() was called for has been checked.
  [[nodiscard]] const HierarchyView& data() const noexcept { return view_; }
  [[nodiscard]] HierarchyData copy_data() const;

  [[nodiscard]] std::size_t vertex_count() const noexcept { return view_.positions.size(); }
  [[nodiscard]] std::size_t split_count() const noexcept { return view_.nodes.empty() ? 0 : view_.nodes.size() - 1; }
  [[nodiscard]] std::size_t base_vertex_count() const noexcept { return vertex_count() - split_count(); }
  [[nodiscard]] std::size_t base_triangle_count() const noexcept { return view_.base_faces.size(); }
  [[nodiscard]] std::size_t face_count() const noexcept { return view_.face_count; }
  [[nodiscard]] std::size_t input_triangle_count() const noexcept { return view_.input_triangle_count; }

  // Makes sure that node, star and vertex of s may be used; splits of base vertices and no_id need nothing. Throws
  // Error when they are damaged. Quick when they have been used before.
  void require(SplitId s) const {
    if (guard_ && s < split_count()) guard_->require(s);
  }
  void require_vertex(VertexId v) const {
    if (v >= base_vertex_count()) require(static_cast<SplitId>(v - base_vertex_count()));
  }
  void require_all() const;

  [[nodiscard]] const SplitNode& node(SplitId s) const noexcept { return view_.nodes[s]; }
  [[nodiscard]] SplitStar star(SplitId s) const noexcept {
    return {view_.stars.data() + view_.nodes[s].star, vertex_of(s)};
  }
  [[nodiscard]] VertexId vertex_of(SplitId s) const noexcept { return static_cast<VertexId>(base_vertex_count() + s); }
  [[nodiscard]] std::span<const glm::vec3> positions() const noexcept { return view_.positions; }

  [[nodiscard]] const Box& box() const noexcept { return view_.box; }
  [[nodiscard]] float error_bound() const noexcept { return view_.error_bound; }
  // Bytes that the arrays occupy.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  HierarchyView view_;
  std::shared_ptr<const void> owner_;
  std::shared_ptr<SplitGuard> guard_;
};

}  // namespace occlod
