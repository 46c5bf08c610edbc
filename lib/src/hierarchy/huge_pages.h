// Large arrays on large pages.
#pragma once

#include <cstddef>
#include <vector>

namespace occlod {

// A hint, before the memory is first touched, where the system takes one: filling it then costs a fault for every 2
// MiB, not for every 4 KiB.
void prefer_huge_pages(void* memory, std::size_t bytes) noexcept;

// An array of so many values, on such pages when it is large.
template <typename T>
[[nodiscard]] std::vector<T> large_array(std::size_t count, const T& value = {}) {
  std::vector<T> result;
  result.reserve(count);
  prefer_huge_pages(result.data(), count * sizeof(T));
  result.resize(count, value);
  return result;
}

}  // namespace occlod
