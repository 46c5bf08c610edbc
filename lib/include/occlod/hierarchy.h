// The hierarchy of splits of one mesh: its arrays, the records of its splits, and the immutable Hierarchy that holds
// them.
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

// The faces that one split changes, read in place from HierarchyView::stars and valid as long as those words are. A
// split brings vertex v back beside its parent vertex u: it inserts the faces around v, its star, and removes the faces
// that take their place without v.
//
// Nearly every star is one fan: its outer vertices in winding order, of which u is one. Face `slot` is (v, ring[slot],
// ring[slot + 1]); for each face without u, (u, ring[slot], ring[slot + 1]) is removed. Any other star lists its faces.
// Words of a record:
//   fan:   header, ring, dependencies, and for each removed face in order of slots one byte, four to a word: its slot
//   << 4 | the index of the dependency that inserted it
//   other: header, u, counts of inserted faces, dependencies and removed faces; three corners of each inserted face;
//   dependencies; for each removed face the split that inserted it or no_id, its slot, three corners
class SplitStar {
 public:
  // Reads the record that begins at `record`, of the split that brings back `vertex`.
  SplitStar(const std::uint32_t* record, VertexId vertex) noexcept : vertex_(vertex) {
    const std::uint32_t header = *record;
    if ((header & other_bit) == 0) {
      ring_ = record + 1;
      ring_size_ = header & 0xFFU;
      parent_place_ = (header >> 8U) & 0xFFU;
      dependency_count_ = (header >> 16U) & 0xFFU;
      inserted_count_ = (header & closed_bit) != 0 ? ring_size_ : ring_size_ - 1;
      removed_count_ = inserted_count_ - (parent_place_ < inserted_count_ ? 1U : 0U) -
                       (parent_place_ > 0 || inserted_count_ == ring_size_ ? 1U : 0U);
      dependencies_ = ring_ + ring_size_;
    } else {
      faces_ = record + 5;
      parent_place_ = record[1];
      inserted_count_ = record[2];
      dependency_count_ = record[3];
      removed_count_ = record[4];
      dependencies_ = faces_ + 3 * inserted_count_;
    }
  }

  // True when the faces form one fan, so that ring() describes them.
  [[nodiscard]] bool is_fan() const noexcept { return faces_ == nullptr; }
  // Returns v, which the split brings back.
  [[nodiscard]] VertexId vertex() const noexcept { return vertex_; }
  // Returns u, into which v had been collapsed.
  [[nodiscard]] VertexId parent_vertex() const noexcept { return is_fan() ? ring_[parent_place_] : parent_place_; }
  // Returns the number of faces that the split inserts, one per slot.
  [[nodiscard]] std::uint32_t inserted_count() const noexcept { return inserted_count_; }
  // Returns the number of faces that the split removes, at most inserted_count().
  [[nodiscard]] std::uint32_t removed_count() const noexcept { return removed_count_; }
  // Returns the splits that must be applied before this one, ascending; all are smaller than it.
  [[nodiscard]] std::span<const SplitId> dependencies() const noexcept { return {dependencies_, dependency_count_}; }
  // Returns the outer vertices in winding order. Only for fans.
  [[nodiscard]] std::span<const VertexId> ring() const noexcept { return {ring_, ring_size_}; }

  // Returns the vertices of face `slot` < inserted_count().
  [[nodiscard]] Triangle inserted(std::uint32_t slot) const noexcept {
    if (is_fan()) return {vertex_, ring_[slot], ring_[next(slot)]};
    const std::uint32_t* const corners = faces_ + 3 * slot;
    return {corners[0], corners[1], corners[2]};
  }

  // Calls visit(Triangle) for each inserted face, in order of slots.
  template <typename Visit>
  void for_each_inserted(const Visit& visit) const {
    for (std::uint32_t slot = 0; slot < inserted_count_; ++slot) visit(inserted(slot));
  }
  // Calls visit(FaceRef, Triangle) for each removed face.
  template <typename Visit>
  void for_each_removed(const Visit& visit) const;
  // Calls visit(FaceRef) for each removed face, in the same order as for_each_removed(); faster when corners are not
  // needed.
  template <typename Visit>
  void for_each_removed_ref(const Visit& visit) const;

  // Calls visit(Triangle) for each inserted and then for each removed face.
  template <typename Visit>
  void for_each_face(const Visit& visit) const {
    for_each_inserted(visit);
    for_each_removed([&](const FaceRef&, const Triangle& t) { visit(t); });
  }

  // Returns the length of the record in words of 32 bits.
  [[nodiscard]] std::size_t word_count() const noexcept {
    const std::size_t head = dependency_count_ + std::size_t{is_fan() ? 1 + ring_size_ : 5 + 3 * inserted_count_};
    return head + (is_fan() ? (removed_count_ + 3) / 4 : 5 * std::size_t{removed_count_});
  }

  static constexpr std::uint32_t max_ring = 30;          // largest number of outer vertices of a fan
  static constexpr std::uint32_t max_dependencies = 16;  // largest number of dependencies of a fan
  static constexpr std::uint32_t max_slots = 16;  // a fan removes only faces with smaller slots, and none of the base
                                                  // mesh
  static constexpr std::uint32_t closed_bit = 1U << 24U;  // in a fan's header: the ring is closed
  static constexpr std::uint32_t other_bit = 1U << 31U;   // in a header: the star is no fan

 private:
  [[nodiscard]] std::uint32_t next(std::uint32_t place) const noexcept {
    return place + 1 == ring_size_ ? 0 : place + 1;
  }
  // Returns the i-th face that a fan removes.
  [[nodiscard]] FaceRef removed_from_fan(std::uint32_t i) const noexcept {
    const std::uint32_t code = dependencies_[dependency_count_ + i / 4] >> (8 * (i % 4));
    return {dependencies_[code & 0xFU], (code >> 4U) & 0xFU};
  }

  VertexId vertex_;
  const std::uint32_t* ring_ = nullptr;   // of a fan; null for any other star
  const std::uint32_t* faces_ = nullptr;  // of any other star; null for a fan
  const std::uint32_t* dependencies_ = nullptr;
  std::uint32_t ring_size_ = 0;
  std::uint32_t parent_place_ = 0;  // place of u in the ring; u itself where the star is no fan
  std::uint32_t inserted_count_ = 0;
  std::uint32_t removed_count_ = 0;
  std::uint32_t dependency_count_ = 0;
};

template <typename Visit>
void SplitStar::for_each_removed(const Visit& visit) const {
  if (!is_fan()) {
    const std::uint32_t* const removed = dependencies_ + dependency_count_;
    for (const std::uint32_t* at = removed; at != removed + 5 * std::size_t{removed_count_}; at += 5)
      visit(FaceRef{at[0], at[1]}, Triangle(at[2], at[3], at[4]));
    return;
  }
  std::uint32_t i = 0;
  for (std::uint32_t slot = 0; slot < inserted_count_; ++slot) {
    if (slot == parent_place_ || next(slot) == parent_place_) continue;
    visit(removed_from_fan(i++), Triangle(ring_[parent_place_], ring_[slot], ring_[next(slot)]));
  }
}

template <typename Visit>
void SplitStar::for_each_removed_ref(const Visit& visit) const {
  if (is_fan())
    for (std::uint32_t i = 0; i < removed_count_; ++i) visit(removed_from_fan(i));
  else
    for_each_removed([&](const FaceRef& face, const Triangle&) { visit(face); });
}

// The wedges at the corners of the faces that one split inserts, read in place from HierarchyView::corners and valid as
// long as those words and the star are. A split whose faces use the first wedge of each of their vertices has no words.
// Words of a record:
//   of a fan: two masks of places in its ring. The first names places whose wedge is not the vertex's first; the second
//   places whose faces on both sides use different wedges. Then the wedges of the places of the first mask, in order;
//   then, for those of the second, the wedge of the face that ends there. Bit 31 of the second mask: v has more than
//   its first wedge. Then follow v's second wedge, and for each slot 4 bits, eight to a word: which wedge of v
//   of any star: explicit_bit, then the three corners of each inserted face
class SplitCorners {
 public:
  // Reads the words of a star; `words` may be empty. O(1).
  SplitCorners(const SplitStar& star, std::span<const std::uint32_t> words) noexcept : star_(star), words_(words) {}

  // True when all corners are the first wedges of their vertices.
  [[nodiscard]] bool are_first() const noexcept { return words_.empty(); }

  // Returns the wedges of face `slot` < inserted_count(), in the order of SplitStar::inserted().
  [[nodiscard]] Triangle inserted(std::uint32_t slot) const noexcept {
    if (words_.empty()) return star_.inserted(slot);
    if ((words_[0] & explicit_bit) != 0) {
      const std::uint32_t* const corners = words_.data() + 1 + 3 * std::size_t{slot};
      return {corners[0], corners[1], corners[2]};
    }
    const std::uint32_t next = slot + 1 == star_.ring().size() ? 0 : slot + 1;
    const std::uint32_t* const wedges = words_.data() + 2;
    const std::uint32_t ends = words_[1] >> next & 1U;
    return {apex(slot), begin_wedge(slot),
            ends != 0 ? wedges[count(words_[0]) + count(words_[1] & below(next))] : begin_wedge(next)};
  }

  static constexpr std::uint32_t explicit_bit = 1U << 31U;  // in the first word: the record has no masks
  static constexpr std::uint32_t apex_bit = 1U << 31U;      // in the second mask: v has more wedges than its first
  static constexpr std::uint32_t max_apex_wedges = 16;      // largest number of wedges of v in a record with masks

  // Returns the number of words of a record with these masks, for a star that inserts `inserted_count` faces.
  [[nodiscard]] static std::size_t word_count(std::uint32_t first_mask, std::uint32_t second_mask,
                                              std::uint32_t inserted_count) noexcept {
    return 2 + count(first_mask) + count(second_mask & ~apex_bit) +
           ((second_mask & apex_bit) != 0 ? 1 + (std::size_t{inserted_count} + 7) / 8 : 0);
  }

 private:
  [[nodiscard]] static std::size_t count(std::uint32_t mask) noexcept {
    return static_cast<std::size_t>(std::popcount(mask));
  }
  [[nodiscard]] static std::uint32_t below(std::uint32_t place) noexcept { return (1U << place) - 1; }
  // Returns the wedge of the vertex at a place of the ring, in the face that begins there.
  [[nodiscard]] WedgeId begin_wedge(std::uint32_t place) const noexcept {
    return (words_[0] >> place & 1U) != 0 ? words_[2 + count(words_[0] & below(place))] : star_.ring()[place];
  }
  // Returns the wedge of v in a face.
  [[nodiscard]] WedgeId apex(std::uint32_t slot) const noexcept {
    if ((words_[1] & apex_bit) == 0) return star_.vertex();
    const std::uint32_t* const at = words_.data() + 2 + count(words_[0]) + count(words_[1] & ~apex_bit);
    const std::uint32_t which = at[1 + slot / 8] >> (4 * (slot % 8)) & 0xFU;
    return which == 0 ? star_.vertex() : at[0] + which - 1;
  }

  SplitStar star_;
  std::span<const std::uint32_t> words_;
};

// Cone, cylinder and box of a subtree, relative to its sphere, in steps of 1/65535 of their ranges. Packing rounds
// outwards: unpacked bounds contain what was packed.
struct PackedBounds {
  std::array<std::uint16_t, 2> axis{};        // octahedral; axis of the cone and of the cylinder
  std::uint16_t cone_cos = 0;                 // [0, 1]; 0 = no cone
  std::uint16_t cylinder_radius = 0;          // [0, radius of the sphere]
  std::array<std::uint16_t, 2> cylinder_t{};  // [-radius, radius]: t_min, t_max
  std::array<std::uint16_t, 3> box_min{};     // [center - radius, center + radius]
  std::array<std::uint16_t, 3> box_max{};     // [center - radius, center + radius]

  // Sets the axis (unit length). Call it first: cone and cylinder are packed around the axis as it unpacks.
  void set_axis(const glm::vec3& direction);
  // Returns the unpacked axis, unit length.
  [[nodiscard]] glm::vec3 unpack_axis() const noexcept;
  // Packs a cone around unpack_axis(); see NormalCone.
  void set_cone(float cos_angle);
  // Packs the cylinder around `sphere.center` and unpack_axis(); it is inside the sphere.
  void set_cylinder(const Sphere& sphere, const Cylinder& cylinder);
  // Packs a box, which is inside the box around the sphere.
  void set_box(const Sphere& sphere, const Box& box);

  // Returns a cone that contains the packed one.
  [[nodiscard]] NormalCone cone() const noexcept;
  // Returns a cylinder that contains the one packed with the same sphere.
  [[nodiscard]] Cylinder cylinder(const Sphere& sphere) const noexcept;
  // Returns a box that contains the one packed with the same sphere.
  [[nodiscard]] Box box(const Sphere& sphere) const noexcept;
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
  std::uint32_t star = 0;         // where its SplitStar starts; it ends where that of the next node starts
  PackedBounds bounds;            // of the subtree

  // Returns a cone that contains the normals of all faces of the subtree.
  [[nodiscard]] NormalCone cone() const noexcept { return bounds.cone(); }
  // Returns a cylinder that contains all faces of the subtree.
  [[nodiscard]] Cylinder cylinder() const noexcept { return bounds.cylinder(sphere); }
  // Returns a box that contains all faces of the subtree.
  [[nodiscard]] Box box() const noexcept { return bounds.box(sphere); }
};
static_assert(sizeof(SplitNode) == 64, "one cache line");

// The arrays of a hierarchy: the recorded collapse sequence of one mesh as a multi-triangulation over one static vertex
// buffer (De Floriani, Magillo, Puppo). Parents come before children. All lengths are in object units.
struct HierarchyView {
  // Wedges: first one for each vertex of the base mesh, then one for vertex base_vertex_count + s of each split s, then
  // the extra ones. See TriangleMesh.
  std::span<const glm::vec3> positions;    // object space
  std::span<const glm::vec3> normals;      // unit length, one per wedge; empty when the input had none
  std::span<const glm::u8vec4> colors;     // sRGB and alpha, one per wedge; empty when the input had none
  std::span<const SplitNode> nodes;        // from coarse to fine, and a sentinel that ends the last split's star
  std::span<const std::uint32_t> stars;    // records of all splits in their order, see SplitStar
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
  std::span<const std::uint32_t> corners;           // records of all splits in their order, see SplitCorners
  std::span<const std::uint32_t> corner_starts;     // where each split's record starts; one more entry, where the last
                                                    // ends
  std::span<const Triangle> base_corners;           // wedges of the corners of base_faces
  std::span<const Material> materials;              // indexed by wedge_materials
  std::span<const Texture> textures;                // indexed by materials
  std::span<const std::uint16_t> attribute_errors;  // one per split, see Hierarchy::attribute_error()
  TextureOrigin texture_origin = TextureOrigin::bottom_left;  // origin of texture_coordinates
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
  // Returns the faces that split s changes. Preconditions as for node().
  [[nodiscard]] SplitStar star(SplitId s) const noexcept {
    return {view_.stars.data() + view_.nodes[s].star, vertex_of(s)};
  }
  // Returns the vertex that split s brings back.
  [[nodiscard]] VertexId vertex_of(SplitId s) const noexcept { return static_cast<VertexId>(base_vertex_count() + s); }
  // True when some vertex has more than one wedge.
  [[nodiscard]] bool has_seams() const noexcept { return !view_.extra_wedges.empty(); }
  // Returns the wedges of the faces that split s inserts. Preconditions as for node().
  [[nodiscard]] SplitCorners corners(SplitId s) const noexcept {
    if (view_.corner_starts.empty()) return {star(s), {}};
    return {star(s),
            view_.corners.subspan(view_.corner_starts[s], view_.corner_starts[s + 1] - view_.corner_starts[s])};
  }
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
