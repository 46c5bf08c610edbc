// The packed records of the faces that splits change, read in place.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/platform.h"
#include "occlod/hierarchy.h"

namespace occlod {

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

// Returns the faces that split s changes. Preconditions as for Hierarchy::node().
[[nodiscard]] inline SplitStar star_of(const Hierarchy& hierarchy, SplitId s) noexcept {
  const HierarchyView& data = hierarchy.data();
  return {data.stars.data() + data.nodes[s].star, hierarchy.vertex_of(s)};
}

// Begins to fetch what star_of() will read of splits soon after the i-th, which are anywhere in memory.
inline void prefetch_stars_after(const Hierarchy& hierarchy, std::span<const SplitId> splits, std::size_t i) noexcept {
  constexpr std::size_t ahead = 8;
  const HierarchyView& data = hierarchy.data();
  if (i + 2 * ahead < splits.size()) prefetch(&data.nodes[splits[i + 2 * ahead]]);
  if (i + ahead < splits.size()) prefetch(data.stars.data() + data.nodes[splits[i + ahead]].star);
}

// Returns the wedges of the faces that split s inserts. Preconditions as for Hierarchy::node().
[[nodiscard]] inline SplitCorners corners_of_star(const Hierarchy& hierarchy, SplitId s) noexcept {
  const HierarchyView& data = hierarchy.data();
  if (data.corner_starts.empty()) return {star_of(hierarchy, s), {}};
  return {star_of(hierarchy, s),
          data.corners.subspan(data.corner_starts[s], data.corner_starts[s + 1] - data.corner_starts[s])};
}

// Returns the wedges at the corners of a face with these vertices, in the same order.
[[nodiscard]] inline Triangle wedges_of_face(const Hierarchy& hierarchy, const FaceRef& face,
                                             const Triangle& vertices) {
  if (!hierarchy.has_seams()) return vertices;
  return face.split == no_id ? hierarchy.data().base_corners[face.slot]
                             : corners_of_star(hierarchy, face.split).inserted(face.slot);
}

}  // namespace occlod
