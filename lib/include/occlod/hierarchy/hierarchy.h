// The recorded collapse sequence of one mesh: a multi-triangulation over one static vertex buffer (De Floriani,
// Magillo, Puppo). Built once, immutable, flat arrays, parents before children. All lengths are object units.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>

#include "occlod/core/ids.h"
#include "occlod/hierarchy/split_node.h"
#include "occlod/hierarchy/split_star.h"
#include "occlod/math/bounds.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// The arrays of a hierarchy, in memory of its own or of a file.
struct HierarchyView {
  // Vertices: first those of the base mesh, then vertex base_vertex_count + s for each split s.
  std::span<const glm::vec3> positions;    // object space
  std::span<const glm::vec3> normals;      // unit length, one per vertex; empty when the input had none
  std::span<const glm::u8vec4> colors;     // sRGB and alpha, one per vertex; empty when the input had none
  std::span<const SplitNode> nodes;        // from coarse to fine, and a sentinel that ends the last one's star
  std::span<const std::uint32_t> stars;    // the records of all splits in their order, see SplitStar
  std::span<const SplitId> roots;          // splits without a forest parent, ascending
  std::span<const Triangle> base_faces;    // of the base mesh, to which no split is applied
  Box box;                                 // of all positions
  std::uint64_t input_triangle_count = 0;  // when all splits are applied
  std::uint64_t face_count = 0;            // that ever existed: of the base mesh and of all stars
  float error_bound = 0.0F;  // the largest guaranteed error of any split: the base mesh is no farther from the input
};

class SplitGuard;

// Immutable; copies share their arrays. Any number of threads may read one.
class Hierarchy {
 public:
  // Of nothing: neither vertices nor splits.
  Hierarchy() = default;
  // Arrays that `owner` keeps alive and that do not change. Their sizes and indices fit together: check_structure() in
  // validate.h returns nothing.
  Hierarchy(const HierarchyView& view, std::shared_ptr<const void> owner);

  // Of a hierarchy in a mapped file only what require() was called for has been checked.
  [[nodiscard]] const HierarchyView& data() const noexcept { return view_; }

  // Of the input mesh.
  [[nodiscard]] std::size_t vertex_count() const noexcept { return view_.positions.size(); }
  // Recorded collapses, each undone by one split.
  [[nodiscard]] std::size_t split_count() const noexcept { return view_.nodes.empty() ? 0 : view_.nodes.size() - 1; }
  // Of the base mesh, to which no split is applied.
  [[nodiscard]] std::size_t base_vertex_count() const noexcept { return vertex_count() - split_count(); }
  // The fewest triangles that a cut can have.
  [[nodiscard]] std::size_t base_triangle_count() const noexcept { return view_.base_faces.size(); }
  // Triangles of the base mesh and of all splits' stars.
  [[nodiscard]] std::size_t face_count() const noexcept { return view_.face_count; }
  // Triangles when all splits are applied.
  [[nodiscard]] std::size_t input_triangle_count() const noexcept { return view_.input_triangle_count; }

  // Call before the first use of split s and its vertex: checks the part of a mapped file that holds them, and throws
  // Error when it is damaged. Nothing to do for no_id, for other hierarchies and when that part has been checked
  // before.
  void require(SplitId s) const {
    if (checked_ != nullptr && s < split_count() && !checked_[s >> block_bits].load(std::memory_order_acquire))
      check_block(s >> block_bits);
  }
  // The same for a vertex; those of the base mesh have been checked on opening.
  void require_vertex(VertexId v) const {
    if (v >= base_vertex_count()) require(static_cast<SplitId>(v - base_vertex_count()));
  }
  // The same for all of them. O(bytes) the first time.
  void require_all() const;

  // s < split_count(), and required.
  [[nodiscard]] const SplitNode& node(SplitId s) const noexcept { return view_.nodes[s]; }
  // The faces that split s changes. The same preconditions.
  [[nodiscard]] SplitStar star(SplitId s) const noexcept {
    return {view_.stars.data() + view_.nodes[s].star, vertex_of(s)};
  }
  // The vertex that split s brings back.
  [[nodiscard]] VertexId vertex_of(SplitId s) const noexcept { return static_cast<VertexId>(base_vertex_count() + s); }
  // Of all vertices, object space: what the triangles of a refinement index.
  [[nodiscard]] std::span<const glm::vec3> positions() const noexcept { return view_.positions; }

  // Around all positions.
  [[nodiscard]] const Box& box() const noexcept { return view_.box; }
  // No cut is farther from the input than this, object units.
  [[nodiscard]] float error_bound() const noexcept { return view_.error_bound; }
  // That the arrays occupy.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  static constexpr std::uint32_t block_bits = 10;  // SplitGuard::block_bits
  friend Hierarchy guarded_hierarchy(const HierarchyView& view, std::shared_ptr<const void> owner,
                                     std::shared_ptr<SplitGuard> guard);
  void check_block(std::size_t block) const;

  HierarchyView view_;
  std::shared_ptr<const void> owner_;
  std::shared_ptr<SplitGuard> guard_;
  const std::atomic<bool>* checked_ = nullptr;  // by block of splits, the guard's; null without a guard
};

}  // namespace occlod
