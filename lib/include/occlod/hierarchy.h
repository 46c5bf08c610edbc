// The few faces that one split changes, read in place from the words that hold them.
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

// Face `slot` of those that `split` inserts; of the base mesh when there is no split.
struct FaceRef {
  SplitId split = no_id;   // that inserts the face; no_id for the base mesh
  std::uint32_t slot = 0;  // index among the faces that it inserts
  friend bool operator==(const FaceRef&, const FaceRef&) = default;
};

// A split brings vertex v back beside its parent vertex u: it inserts the faces around v, its star, and removes the
// faces that take their place without v. A SplitStar points into HierarchyView::stars and is valid as long as that is.
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
  // Of the record that begins at `record`, of the split that brings back `vertex`.
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

  // Whether the faces form one fan, so that ring() describes them.
  [[nodiscard]] bool is_fan() const noexcept { return faces_ == nullptr; }
  // v, which the split brings back.
  [[nodiscard]] VertexId vertex() const noexcept { return vertex_; }
  // u, which v had been collapsed into.
  [[nodiscard]] VertexId parent_vertex() const noexcept { return is_fan() ? ring_[parent_place_] : parent_place_; }
  // Faces that the split inserts, one per slot.
  [[nodiscard]] std::uint32_t inserted_count() const noexcept { return inserted_count_; }
  // Faces that the split removes, no more than it inserts.
  [[nodiscard]] std::uint32_t removed_count() const noexcept { return removed_count_; }
  // The splits that must be applied before this one: ascending, all smaller than it.
  [[nodiscard]] std::span<const SplitId> dependencies() const noexcept { return {dependencies_, dependency_count_}; }
  // Of a fan: the outer vertices in winding order.
  [[nodiscard]] std::span<const VertexId> ring() const noexcept { return {ring_, ring_size_}; }

  // Face `slot` < inserted_count(), by its vertices.
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
  // Calls visit(FaceRef) for each removed face, in the same order; quicker, where corners are not needed.
  template <typename Visit>
  void for_each_removed_ref(const Visit& visit) const;

  // Calls visit(Triangle) for each inserted and then for each removed face.
  template <typename Visit>
  void for_each_face(const Visit& visit) const {
    for_each_inserted(visit);
    for_each_removed([&](const FaceRef&, const Triangle& t) { visit(t); });
  }

  // Length of the record, in words of 32 bits.
  [[nodiscard]] std::size_t word_count() const noexcept {
    const std::size_t head = dependency_count_ + std::size_t{is_fan() ? 1 + ring_size_ : 5 + 3 * inserted_count_};
    return head + (is_fan() ? (removed_count_ + 3) / 4 : 5 * std::size_t{removed_count_});
  }

  static constexpr std::uint32_t max_ring = 30;          // outer vertices of a fan
  static constexpr std::uint32_t max_dependencies = 16;  // of a fan
  static constexpr std::uint32_t max_slots = 16;  // a fan removes faces with smaller slots only, and none of the base
  static constexpr std::uint32_t closed_bit = 1U << 24U;  // of a fan's header: the ring is closed
  static constexpr std::uint32_t other_bit = 1U << 31U;   // of a header: no fan

 private:
  [[nodiscard]] std::uint32_t next(std::uint32_t place) const noexcept {
    return place + 1 == ring_size_ ? 0 : place + 1;
  }
  // The i-th.
  [[nodiscard]] FaceRef removed_from_fan(std::uint32_t i) const noexcept {
    const std::uint32_t code = dependencies_[dependency_count_ + i / 4] >> (8 * (i % 4));
    return {dependencies_[code & 0xFU], (code >> 4U) & 0xFU};
  }

  VertexId vertex_;
  const std::uint32_t* ring_ = nullptr;   // of a fan
  const std::uint32_t* faces_ = nullptr;  // of any other star
  const std::uint32_t* dependencies_ = nullptr;
  std::uint32_t ring_size_ = 0;
  std::uint32_t parent_place_ = 0;  // of u in the ring; of any other star u itself
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

// The wedges at the corners of the faces that one split inserts, read in place from the words that hold them.

// Points into HierarchyView::corners and is valid as long as that and the star are. A split whose faces use the first
// wedge of each of their vertices has no words. Words of a record:
//   of a fan: two masks of places in its ring. The first names places whose wedge is not the vertex's first; the second
//   places whose faces on both sides use different wedges. Then the wedges of the places of the first mask, in order;
//   then, for those of the second, the wedge of the face that ends there. Bit 31 of the second mask: v has more than
//   its first wedge. Then follow v's second wedge, and for each slot 4 bits, eight to a word: which wedge of v
//   of any star: explicit_bit, then the three corners of each inserted face
class SplitCorners {
 public:
  // Of a star and its words, which may be none. O(1).
  SplitCorners(const SplitStar& star, std::span<const std::uint32_t> words) noexcept : star_(star), words_(words) {}

  // Whether all corners are the first wedges of their vertices.
  [[nodiscard]] bool are_first() const noexcept { return words_.empty(); }

  // The wedges of face `slot` < inserted_count(), in the order of SplitStar::inserted().
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

  static constexpr std::uint32_t explicit_bit = 1U << 31U;  // of the first word: no masks
  static constexpr std::uint32_t apex_bit = 1U << 31U;      // of the second mask: v has more wedges than its first
  static constexpr std::uint32_t max_apex_wedges = 16;      // of v, in a record with masks

  // The words of a record with these masks, of a star that inserts so many faces.
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
  // Of the vertex at a place of the ring, in the face that begins there.
  [[nodiscard]] WedgeId begin_wedge(std::uint32_t place) const noexcept {
    return (words_[0] >> place & 1U) != 0 ? words_[2 + count(words_[0] & below(place))] : star_.ring()[place];
  }
  // Of v in a face.
  [[nodiscard]] WedgeId apex(std::uint32_t slot) const noexcept {
    if ((words_[1] & apex_bit) == 0) return star_.vertex();
    const std::uint32_t* const at = words_.data() + 2 + count(words_[0]) + count(words_[1] & ~apex_bit);
    const std::uint32_t which = at[1 + slot / 8] >> (4 * (slot % 8)) & 0xFU;
    return which == 0 ? star_.vertex() : at[0] + which - 1;
  }

  SplitStar star_;
  std::span<const std::uint32_t> words_;
};

// What refinement reads for every split it looks at: one cache line.

// Cone, cylinder and box of a subtree, relative to its sphere, in steps of 1/65535 of their ranges. Packing rounds
// outwards: unpacked bounds contain what was packed.
struct PackedBounds {
  std::array<std::uint16_t, 2> axis{};        // octahedral; of the cone and of the cylinder
  std::uint16_t cone_cos = 0;                 // [0, 1]; 0 = no cone
  std::uint16_t cylinder_radius = 0;          // [0, radius of the sphere]
  std::array<std::uint16_t, 2> cylinder_t{};  // [-radius, radius]: t_min, t_max
  std::array<std::uint16_t, 3> box_min{};     // [center - radius, center + radius]
  std::array<std::uint16_t, 3> box_max{};     // likewise

  // Unit length. To be set first: cone and cylinder are packed around the axis as it unpacks.
  void set_axis(const glm::vec3& direction);
  // Unit length.
  [[nodiscard]] glm::vec3 unpack_axis() const noexcept;
  // A cone around unpack_axis(); see NormalCone.
  void set_cone(float cos_angle);
  // The cylinder around `sphere.center` and unpack_axis(), inside the sphere.
  void set_cylinder(const Sphere& sphere, const Cylinder& cylinder);
  // A box inside the box around the sphere.
  void set_box(const Sphere& sphere, const Box& box);

  // Contains what was packed.
  [[nodiscard]] NormalCone cone() const noexcept;
  // Contains what was packed with the same sphere.
  [[nodiscard]] Cylinder cylinder(const Sphere& sphere) const noexcept;
  // Contains what was packed with the same sphere.
  [[nodiscard]] Box box(const Sphere& sphere) const noexcept;
};

// Split s brings back vertex base_vertex_count + s. Its bounds contain every face that it or a split below it in the
// forest removes or inserts. Object space, object units.
struct SplitNode {
  Sphere sphere;       // around the subtree
  float error = 0.0F;  // quadric error, about a root mean square distance; no less than that of any split that depends
                       // on this one or is below it in the forest
  float guaranteed_error = 0.0F;  // bound on the distance between the surface without this split and the input; no less
                                  // than below, likewise
  SplitId child_u = no_id;        // forest: the next split of the same parent vertex
  SplitId child_v = no_id;        // forest: the first split of the vertex that this one brings back
  SplitId parent = no_id;         // forest; none at roots
  std::uint32_t star = 0;         // where its SplitStar starts; that of the next node is where it ends
  PackedBounds bounds;            // of the subtree

  // Contains the normals of all faces of the subtree.
  [[nodiscard]] NormalCone cone() const noexcept { return bounds.cone(); }
  // Contains the subtree, and so does box().
  [[nodiscard]] Cylinder cylinder() const noexcept { return bounds.cylinder(sphere); }
  // Contains the subtree.
  [[nodiscard]] Box box() const noexcept { return bounds.box(sphere); }
};
static_assert(sizeof(SplitNode) == 64, "one cache line");

// The recorded collapse sequence of one mesh: a multi-triangulation over one static vertex buffer (De Floriani,
// Magillo, Puppo). Built once, immutable, flat arrays, parents before children. All lengths are object units.

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
