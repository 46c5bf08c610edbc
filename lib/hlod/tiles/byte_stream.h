// What an accessor reads: elements of one size, in little-endian bytes.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <string>

namespace occlod::tiles {

class ByteStream {
 public:
  ByteStream(std::size_t stride, std::size_t count) : stride_(stride), count_(count) { bytes_.reserve(stride * count); }

  // `count` times `stride` bytes in all.
  template <class... Numbers>
  void add(Numbers... values) {
    (add_one(values), ...);
  }
  [[nodiscard]] std::size_t stride() const noexcept { return stride_; }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }

 private:
  template <class Number>
  void add_one(Number value) {
    auto bytes = std::bit_cast<std::array<char, sizeof(Number)>>(value);
    if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
    bytes_.append(bytes.data(), bytes.size());
  }

  std::size_t stride_;
  std::size_t count_;
  std::string bytes_;
};

}  // namespace occlod::tiles
