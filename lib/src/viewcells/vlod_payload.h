// What a node of the tree of cells adds, as bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace occlod::vlod {

// By the numbers of GlobalIds.
struct Additions {
  std::vector<std::uint64_t> splits;  // ascending
  std::vector<std::uint64_t> hidden;  // faces, ascending: owner << 32 | slot
};

[[nodiscard]] std::vector<std::byte> encode(const Additions& additions);

// What was encoded must have.
struct Expected {
  std::uint64_t split_count = 0, owner_count = 0;  // of GlobalIds
  std::size_t splits = 0, hidden = 0;              // numbers of elements
};
// Nothing, and what is wrong in `problem`, when the bytes do not hold that.
[[nodiscard]] std::optional<Additions> decode(std::span<const std::byte> bytes, const Expected& expected,
                                              std::string& problem);

}  // namespace occlod::vlod
