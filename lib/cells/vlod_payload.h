// What a node of the tree of cells adds, as bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace occlod::vlod {

// By the numbers of GlobalIds; all ascending.
struct Additions {
  std::vector<std::uint64_t> splits;
  std::vector<std::uint64_t> candidates;  // splits; none that is added
  std::vector<std::uint64_t> hidden;      // faces: owner << 32 | slot
};

// Splits that are among `known`, ascending, are coded as places there, which takes about half the bits: what the node
// above has as candidates. `most_ids_per_byte`: filled up with zeros, so that there are no more.
[[nodiscard]] std::vector<std::byte> encode(const Additions& additions, std::span<const std::uint64_t> known,
                                            std::uint32_t most_ids_per_byte);

// What was encoded must have.
struct Expected {
  std::uint64_t split_count = 0, owner_count = 0;      // of GlobalIds
  std::size_t splits = 0, candidates = 0, hidden = 0;  // numbers of elements
};
// Nothing, and what is wrong in `problem`, when the bytes do not hold that.
[[nodiscard]] std::optional<Additions> decode(std::span<const std::byte> bytes, const Expected& expected,
                                              std::span<const std::uint64_t> known, std::string& problem);

}  // namespace occlod::vlod
