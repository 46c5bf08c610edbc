// One value per split of a hierarchy that may be larger than any view of it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

namespace occlod {

template <typename T>
using ZeroedArray = std::unique_ptr<T[], decltype(&std::free)>;

// All zero. From calloc: pages that are never touched are never allocated. Throws std::bad_alloc.
template <typename T>
[[nodiscard]] ZeroedArray<T> zeroed_array(std::size_t count) {
  static_assert(std::is_trivial_v<T>);
  void* const memory = std::calloc(std::max<std::size_t>(count, 1), sizeof(T));
  if (memory == nullptr) throw std::bad_alloc();
  return {static_cast<T*>(memory), &std::free};
}

}  // namespace occlod
