// Numbers in files of either byte order.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

namespace occlod {

// The sizeof(Number) bytes at `at`, which need not be aligned.
template <class Number>
[[nodiscard]] Number load(const char* at, std::endian order) noexcept {
  std::array<char, sizeof(Number)> bytes;
  std::memcpy(bytes.data(), at, sizeof(Number));
  if (order != std::endian::native) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<Number>(bytes);
}

}  // namespace occlod
