// The hierarchy of splits of one mesh: its arrays, and the immutable Hierarchy that holds them.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "occlod/base.h"
#include "occlod/bounds.h"
#include "occlod/mesh.h"

namespace occlod {

// Names face `slot` of those that `split` inserts, or of the base mesh when there is no split.
struct FaceRef {
  SplitId split = no_id;   // inserts the face; no_id for the base mesh
  std::uint32_t slot = 0;  // index among the faces that the split inserts
  friend bool operator==(const FaceRef&, const FaceRef&) = default;
};

// The faces that one split changes, as values. A split brings vertex v back beside its parent vertex u: it inserts the
// faces around v, its star, and removes the faces that take their place without v.
struct SplitFaces {
  VertexId vertex = no_id;                // v
  VertexId parent_vertex = no_id;         // u, into which v had been collapsed
  std::vector<SplitId> dependencies;      // splits that must be applied before, ascending; all are smaller
  std::vector<Triangle> inserted;         // vertices of each inserted face; its index is FaceRef::slot
  std::vector<Triangle> inserted_wedges;  // wedges at their corners
  std::vector<FaceRef> removed_refs;      // names of the removed faces
  std::vector<Triangle> removed;          // vertices of each of them
};

// The record of one split, one cache line, which refinement reads for every split that it visits. Split s brings back
// vertex base_vertex_count + s. Its bounds contain every face that it or a split below it in the forest removes or
// inserts. Object space, object units.
struct SplitNode {
  Sphere sphere;       // around the subtree
  float error = 0.0F;  // quadric error, about a root mean square distance; at least that of any split that depends on
                       // this one or is below it in the forest
  float guaranteed_error = 0.0F;  // bound on the distance between the surface without this split and the input; at
                                  // least that of any split that depends on this one or is below it in the forest
  SplitId child_u = no_id;        // forest: the next split of the same parent vertex
  SplitId child_v = no_id;        // forest: the first split of the vertex that this one brings back
  SplitId parent = no_id;         // forest; none at roots
  std::uint32_t star = 0;  // start of its words in HierarchyView::stars; they end where those of the next node start
  std::array<std::uint16_t, 12> bounds{};  // of the subtree, packed: cone(), cylinder() and box() unpack them

  // Returns a cone that contains the normals of all faces of the subtree.
  [[nodiscard]] NormalCone cone() const noexcept;
  // Returns a cylinder that contains all faces of the subtree.
  [[nodiscard]] Cylinder cylinder() const noexcept;
  // Returns a box that contains all faces of the subtree.
  [[nodiscard]] Box box() const noexcept;
};

// The arrays of a hierarchy: the recorded collapse sequence of one mesh as a multi-triangulation over one static vertex
// buffer (De Floriani, Magillo, Puppo). Parents come before children. All lengths are in object units.
struct HierarchyView {
  // Wedges: first one for each vertex of the base mesh, then one for vertex base_vertex_count + s of each split s, then
  // the extra ones. See TriangleMesh.
  std::span<const glm::vec3> positions;    // object space, relative to `origin`
  std::span<const glm::vec3> normals;      // unit length, one per wedge; empty when the input had none
  std::span<const glm::u8vec4> colors;     // sRGB and alpha, one per wedge; empty when the input had none
  std::span<const SplitNode> nodes;        // from coarse to fine, and a sentinel that ends the last split's star
  std::span<const std::uint32_t> stars;    // packed faces of all splits, see Hierarchy::faces_of()
  std::span<const SplitId> roots;          // splits without a forest parent, ascending
  std::span<const Triangle> base_faces;    // faces of the base mesh, to which no split is applied
  Box box;                                 // around all positions
  std::uint64_t input_triangle_count = 0;  // triangles when all splits are applied
  std::uint64_t face_count = 0;            // all faces that ever existed: of the base mesh and of all stars
  float error_bound = 0.0F;  // the largest guaranteed error of any split: the base mesh is no farther from the input

  // The arrays for seams and materials are empty for an input without them.
  std::span<const glm::vec2> texture_coordinates;   // as the input has them, one per wedge
  std::span<const VertexId> extra_wedges;           // vertices of the extra wedges, ascending
  std::span<const MaterialId> wedge_materials;      // one per wedge; empty: all triangles have the first, if any
  std::span<const std::uint32_t> corners;           // packed wedges at the corners of all splits' faces
  std::span<const std::uint32_t> corner_starts;     // where each split's record starts; one more entry, where the last
                                                    // ends
  std::span<const Triangle> base_corners;           // wedges of the corners of base_faces
  std::span<const Material> materials;              // indexed by wedge_materials
  std::span<const Texture> textures;                // indexed by materials
  std::span<const std::uint16_t> attribute_errors;  // one per split, see Hierarchy::attribute_error()
  TextureOrigin texture_origin = TextureOrigin::bottom_left;  // origin of texture_coordinates
  glm::dvec3 origin{0.0};  // coordinates are origin + position, see TriangleMesh::origin and positions_to_world()
  UpAxis up = UpAxis::z;   // of the input
};

class SplitGuard;

// The recorded collapses of one mesh, which build_hierarchy() makes. Immutable; copies share their arrays. Any number
// of threads may read one.
class Hierarchy {
 public:
  // Makes an empty hierarchy without vertices and splits.
  Hierarchy() = default;
  // Uses arrays that `owner` keeps alive and that do not change. Their sizes and indices fit together:
  // check_structure() in occlod/build_hierarchy.h returns nothing.
  Hierarchy(const HierarchyView& view, std::shared_ptr<const void> owner);

  // Returns the arrays. In a mapped file only the parts for which require() was called have been checked.
  [[nodiscard]] const HierarchyView& data() const noexcept { return view_; }

  // Returns the number of vertices of the input mesh.
  [[nodiscard]] std::size_t vertex_count() const noexcept { return wedge_count() - view_.extra_wedges.size(); }
  // Returns the number of vertices with their attributes: those of the input mesh and those that collapses across seams
  // have added.
  [[nodiscard]] std::size_t wedge_count() const noexcept { return view_.positions.size(); }
  // Returns the number of recorded collapses; one split undoes each.
  [[nodiscard]] std::size_t split_count() const noexcept { return view_.nodes.empty() ? 0 : view_.nodes.size() - 1; }
  // Returns the number of vertices of the base mesh, to which no split is applied.
  [[nodiscard]] std::size_t base_vertex_count() const noexcept { return vertex_count() - split_count(); }
  // Returns the number of triangles of the base mesh, the fewest that a cut can have.
  [[nodiscard]] std::size_t base_triangle_count() const noexcept { return view_.base_faces.size(); }
  // Returns the number of triangles of the base mesh and of all splits' stars.
  [[nodiscard]] std::size_t face_count() const noexcept { return view_.face_count; }
  // Returns the number of triangles when all splits are applied.
  [[nodiscard]] std::size_t input_triangle_count() const noexcept { return view_.input_triangle_count; }

  // Checks the part of a mapped file that holds split s and its vertex, and throws Error when it is damaged. Call it
  // before the first use of the split. Does nothing for no_id, for hierarchies that are not mapped and for parts that
  // were checked before.
  void require(SplitId s) const {
    if (checked_ != nullptr && s < split_count() && !checked_[s >> block_bits].load(std::memory_order_acquire))
      check_block(s >> block_bits);
  }
  // Does what require() does, for a vertex; vertices of the base mesh have been checked on opening.
  void require_vertex(VertexId v) const {
    if (v >= base_vertex_count()) require(static_cast<SplitId>(v - base_vertex_count()));
  }
  // Does what require() does, for all splits. O(bytes) the first time.
  void require_all() const;

  // Returns the node of split s < split_count(), for which require() has been called.
  [[nodiscard]] const SplitNode& node(SplitId s) const noexcept { return view_.nodes[s]; }
  // Returns the faces that split s changes. Preconditions as for node(). O(faces).
  [[nodiscard]] SplitFaces faces_of(SplitId s) const;
  // Returns the vertex that split s brings back.
  [[nodiscard]] VertexId vertex_of(SplitId s) const noexcept { return static_cast<VertexId>(base_vertex_count() + s); }
  // Returns the vertex into which that of split s had been collapsed. Preconditions as for node(). O(1).
  [[nodiscard]] VertexId parent_vertex(SplitId s) const noexcept;
  // True when some vertex has more than one wedge.
  [[nodiscard]] bool has_seams() const noexcept { return !view_.extra_wedges.empty(); }
  // Returns how far attributes are off without split s, as a length on the surface in object units: about the root mean
  // square over the surface that the split restores, and at least that of any split that depends on this one or is
  // below it in the forest. 0 for an input without seams and texture coordinates. Preconditions as for node().
  [[nodiscard]] float attribute_error(SplitId s) const noexcept {
    return view_.attribute_errors.empty() ? 0.0F
                                          : std::bit_cast<float>(std::uint32_t{view_.attribute_errors[s]} << 16U);
  }
  // Returns the vertex of a wedge.
  [[nodiscard]] VertexId vertex_of_wedge(WedgeId wedge) const noexcept {
    return wedge < vertex_count() ? wedge : view_.extra_wedges[wedge - vertex_count()];
  }
  // Returns the material of a face with this wedge, an index into HierarchyView::materials; also 0 when there are none.
  [[nodiscard]] MaterialId material_of(WedgeId wedge) const noexcept {
    return view_.wedge_materials.empty() ? MaterialId{0} : view_.wedge_materials[wedge];
  }
  // Returns the positions of all wedges, object space: the triangles of a refinement index them.
  [[nodiscard]] std::span<const glm::vec3> positions() const noexcept { return view_.positions; }

  // Returns the box around all positions.
  [[nodiscard]] const Box& box() const noexcept { return view_.box; }
  // Returns a bound on the distance of any cut from the input, object units.
  [[nodiscard]] float error_bound() const noexcept { return view_.error_bound; }
  // Returns the number of bytes that the arrays occupy.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  static constexpr std::uint32_t block_bits = 10;  // equals SplitGuard::block_bits
  friend Hierarchy guarded_hierarchy(const HierarchyView& view, std::shared_ptr<const void> owner,
                                     std::shared_ptr<SplitGuard> guard);
  void check_block(std::size_t block) const;

  HierarchyView view_;
  std::shared_ptr<const void> owner_;
  std::shared_ptr<SplitGuard> guard_;
  const std::atomic<bool>* checked_ = nullptr;  // the guard's flags by block of splits; null without a guard
};

}  // namespace occlod
