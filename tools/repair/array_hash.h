// Hashes arrays of numbers, for keys of unordered containers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

namespace occlod::repair {

template <typename Array>
struct ArrayHash {
  std::size_t operator()(const Array& array) const noexcept {
    std::uint64_t hash = 0;
    for (const auto& x : array) {
      hash = (hash ^ std::hash<typename Array::value_type>{}(x)) * 0x9e3779b97f4a7c15U;
      hash ^= hash >> 32U;
    }
    return hash;
  }
};

}  // namespace occlod::repair
