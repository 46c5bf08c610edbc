// Numbers distinct positions in the order in which they are met.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>

#include "base/large_vector.h"
#include "occlod/core/ids.h"

namespace occlod {

// An open hash table. Finite positions; +0 and -0 are one.
class PositionIds {
 public:
  // Holds up to so many.
  explicit PositionIds(std::size_t most_positions)
      : slots_(std::bit_ceil(2 * most_positions + 1), no_id), mask_(slots_.size() - 1) {
    positions_.reserve(most_positions);
  }

  // The number of p, a new one when it has none.
  std::uint32_t add(const glm::vec3& p) {
    std::uint32_t& slot = slots_[find_slot(p)];
    if (slot == no_id) {
      slot = static_cast<std::uint32_t>(positions_.size());
      positions_.push_back(p);
    }
    return slot;
  }
  // The number of p, or no_id.
  [[nodiscard]] std::uint32_t find(const glm::vec3& p) const { return slots_[find_slot(p)]; }
  // By number.
  [[nodiscard]] const LargeVector<glm::vec3>& positions() const { return positions_; }

 private:
  [[nodiscard]] std::size_t find_slot(const glm::vec3& p) const {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis)
      hash = (hash ^ std::bit_cast<std::uint32_t>(p[axis] + 0.0F)) * 0x9e3779b97f4a7c15ULL;  // -0 becomes 0
    std::size_t slot = (hash ^ hash >> 32U) & mask_;
    while (slots_[slot] != no_id && positions_[slots_[slot]] != p) slot = (slot + 1) & mask_;
    return slot;
  }

  LargeVector<glm::vec3> positions_;
  LargeVector<std::uint32_t> slots_;
  std::size_t mask_;
};

}  // namespace occlod
