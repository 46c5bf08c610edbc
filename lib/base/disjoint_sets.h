// Disjoint sets of numbers (union-find), each named by its least member.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "base/memory.h"

namespace occlod {

class DisjointSets {
 public:
  // Makes `count` sets of one number each.
  void reset(std::size_t count) {
    parent_.resize(count);
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  // Returns the least member of the set that holds i.
  [[nodiscard]] std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  // Returns false when the two were in one set already.
  bool join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    if (a == b) return false;
    parent_[std::max(a, b)] = std::min(a, b);
    return true;
  }

 private:
  LargeVector<std::uint32_t> parent_;
};

}  // namespace occlod
