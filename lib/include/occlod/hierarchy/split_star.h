// The few faces that one split changes, read in place from the words that hold them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "occlod/core/ids.h"
#include "occlod/mesh/triangle_mesh.h"

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

  static constexpr std::uint32_t most_ring = 30;          // outer vertices of a fan
  static constexpr std::uint32_t most_dependencies = 16;  // of a fan
  static constexpr std::uint32_t most_slots = 16;  // a fan removes faces with smaller slots only, and none of the base
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

}  // namespace occlod
