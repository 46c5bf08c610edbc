// Numbers distinct positions in the order in which they are added.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "base/memory.h"
#include "occlod/base.h"
#include "occlod/bounds.h"

namespace occlod {

// An open-addressing hash table. Positions must be finite; +0 and -0 are equal.
class PositionIds {
 public:
  // Reserves room for this many positions.
  explicit PositionIds(std::size_t max_positions)
      : slots_(std::bit_ceil(2 * max_positions + 1), no_id), mask_(slots_.size() - 1) {
    positions_.reserve(max_positions);
  }

  // Returns the number of p; assigns a new one when it has none.
  std::uint32_t add(const glm::vec3& p) {
    std::uint32_t& slot = slots_[find_slot(p)];
    if (slot == no_id) {
      slot = static_cast<std::uint32_t>(positions_.size());
      positions_.push_back(p);
    }
    return slot;
  }
  // Returns the number of p, or no_id.
  [[nodiscard]] std::uint32_t find(const glm::vec3& p) const { return slots_[find_slot(p)]; }
  // Returns the positions by number.
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

// Reads positions from different memory layouts.

// A non-owning view of an array of positions, or of records that hold one position each.
class PositionView {
 public:
  PositionView(std::span<const glm::vec3> positions) : first_(positions.data()), stride_(sizeof(glm::vec3)) {}
  PositionView(const std::vector<glm::vec3>& positions) : PositionView(std::span(positions)) {}
  template <typename Record>
  PositionView(std::span<const Record> records, glm::vec3 Record::*member)
      : first_(records.empty() ? nullptr : &(records[0].*member)), stride_(sizeof(Record)) {}

  const glm::vec3& operator[](std::size_t v) const noexcept {
    return *reinterpret_cast<const glm::vec3*>(reinterpret_cast<const std::byte*>(first_) + v * stride_);
  }

 private:
  const glm::vec3* first_;
  std::size_t stride_;
};

// Converts between object units and units in which a mesh is about 1 wide, so that squares and their products stay in
// range.

// Returns the power of two, exact to multiply with, that scales the extent of the positions into [1/2, 1]; within
// 2^-126 and 2^126, so that its inverse exists.
[[nodiscard]] inline float power_of_two_scale(std::span<const glm::vec3> positions) {
  const Box box = bounding_box(positions);
  const glm::dvec3 size = glm::dvec3(box.max) - glm::dvec3(box.min);
  int exponent = 0;
  (void)std::frexp(std::max({size.x, size.y, size.z}), &exponent);
  return std::ldexp(1.0F, -std::clamp(exponent, -126, 126));
}

// Returns length * factor, never less than the exact product even where it is denormal.
[[nodiscard]] inline float scaled_up(float length, float factor) {
  const float product = length * factor;
  const bool may_be_less = product < std::numeric_limits<float>::min() && length > 0.0F;
  return may_be_less ? std::nextafter(product, 1.0F) : product;
}

}  // namespace occlod
