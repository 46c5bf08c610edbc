// Which parts of a buffer are in use. No OpenGL here.
#pragma once

#include <cstddef>
#include <map>
#include <optional>

namespace occlod::gl {

// Ranges of [0, size) that do not overlap; free neighbours are one.
class RangeAllocator {
 public:
  explicit RangeAllocator(std::size_t size);
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  // The start of a free range of so many, > 0: the first in the smallest gap that has room. O(gaps).
  [[nodiscard]] std::optional<std::size_t> take(std::size_t count);
  // Frees a range as take() gave it. O(log gaps).
  void give_back(std::size_t first, std::size_t count);

 private:
  std::size_t size_;
  std::map<std::size_t, std::size_t> gaps_;  // first to count
};

}  // namespace occlod::gl
