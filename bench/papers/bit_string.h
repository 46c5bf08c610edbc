// Bits, written and read one after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace occlod::paper {

// The first bit is the highest of the first byte.
class BitString {
 public:
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool operator[](std::size_t i) const noexcept { return ((bytes_[i / 8] >> (7 - i % 8)) & 1U) != 0; }
  void push(bool bit) {
    if (size_ % 8 == 0) bytes_.push_back(0);
    if (bit) bytes_.back() = static_cast<std::uint8_t>(bytes_.back() | (1U << (7 - size_ % 8)));
    ++size_;
  }
  friend bool operator==(const BitString&, const BitString&) = default;

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t size_ = 0;
};

}  // namespace occlod::paper
