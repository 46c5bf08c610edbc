// The recorded collapse sequence of one mesh: a multi-triangulation over one static vertex buffer (De Floriani,
// Magillo, Puppo). Built once, immutable, flat arrays, parents before children. All lengths are object units.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>

#include "occlod/core/ids.h"
#include "occlod/hierarchy/split_corners.h"
#include "occlod/hierarchy/split_node.h"
#include "occlod/hierarchy/split_star.h"
#include "occlod/math/bounds.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// The arrays of a hierarchy, in memory of its own or of a file.
struct HierarchyView {
  // Wedges: first those of the vertices of the base mesh, then of vertex base_vertex_count + s for each split s, then
  // the extra ones. See TriangleMesh.
  std::span<const glm::vec3> positions;    // object space
  std::span<const glm::vec3> normals;      // unit length, one per wedge; empty when the input had none
  std::span<const glm::u8vec4> colors;     // sRGB and alpha, one per wedge; empty when the input had none
  std::span<const SplitNode> nodes;        // from coarse to fine, and a sentinel that ends the last one's star
  std::span<const std::uint32_t> stars;    // the records of all splits in their order, see SplitStar
  std::span<const SplitId> roots;          // splits without a forest parent, ascending
  std::span<const Triangle> base_faces;    // of the base mesh, to which no split is applied
  Box box;                                 // of all positions
  std::uint64_t input_triangle_count = 0;  // when all splits are applied
  std::uint64_t face_count = 0;            // that ever existed: of the base mesh and of all stars
  float error_bound = 0.0F;  // the largest guaranteed error of any split: the base mesh is no farther from the input

  // What seams and materials add. All of it is empty for an input without.
  std::span<const glm::vec2> texture_coordinates;   // as the input has them, one per wedge
  std::span<const VertexId> extra_wedges;           // their vertices, ascending
  std::span<const MaterialId> wedge_materials;      // one per wedge; empty: all triangles have the first, if any
  std::span<const std::uint32_t> corners;           // the records of all splits in their order, see SplitCorners
  std::span<const std::uint32_t> corner_starts;     // where each split's record starts; one more, where the last ends
  std::span<const Triangle> base_corners;           // wedges of the corners of base_faces
  std::span<const Material> materials;              // that wedge_materials indexes
  std::span<const Texture> textures;                // that materials index
  std::span<const std::uint16_t> attribute_errors;  // by split, see Hierarchy::attribute_error()
  TextureOrigin texture_origin = TextureOrigin::bottom_left;  // of texture_coordinates
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
  [[nodiscard]] std::size_t vertex_count() const noexcept { return wedge_count() - view_.extra_wedges.size(); }
  // Vertices with their attributes: those of the input mesh, and those that collapses across seams have added.
  [[nodiscard]] std::size_t wedge_count() const noexcept { return view_.positions.size(); }
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
  // Whether some vertex has more than one wedge.
  [[nodiscard]] bool has_seams() const noexcept { return !view_.extra_wedges.empty(); }
  // The wedges of the faces that split s inserts. The preconditions of star().
  [[nodiscard]] SplitCorners corners(SplitId s) const noexcept {
    if (view_.corner_starts.empty()) return {star(s), {}};
    return {star(s),
            view_.corners.subspan(view_.corner_starts[s], view_.corner_starts[s + 1] - view_.corner_starts[s])};
  }
  // How far attributes are off without split s, as a length on the surface: about the root mean square over the surface
  // that the split restores, object units; no less than that of any split that depends on this one or is below it in
  // the forest. 0 for an input without seams and texture coordinates. The preconditions of node().
  [[nodiscard]] float attribute_error(SplitId s) const noexcept {
    return view_.attribute_errors.empty() ? 0.0F
                                          : std::bit_cast<float>(std::uint32_t{view_.attribute_errors[s]} << 16U);
  }
  // The vertex of a wedge.
  [[nodiscard]] VertexId vertex_of_wedge(WedgeId wedge) const noexcept {
    return wedge < vertex_count() ? wedge : view_.extra_wedges[wedge - vertex_count()];
  }
  // The material of a face with that wedge: an index into HierarchyView::materials. 0 too when there are none.
  [[nodiscard]] MaterialId material_of(WedgeId wedge) const noexcept {
    return view_.wedge_materials.empty() ? MaterialId{0} : view_.wedge_materials[wedge];
  }
  // Of all wedges, object space: what the triangles of a refinement index.
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
