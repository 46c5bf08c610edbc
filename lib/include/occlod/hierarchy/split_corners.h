// The wedges at the corners of the faces that one split inserts, read in place from the words that hold them.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "occlod/core/ids.h"
#include "occlod/hierarchy/split_star.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

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
  static constexpr std::uint32_t most_apex_wedges = 16;     // of v, in a record with masks

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

}  // namespace occlod
