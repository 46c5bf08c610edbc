// Large memory in files, while a MemoryLimit lives.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace occlod {

namespace memory_limit {
inline std::atomic<bool> lives = false;  // while a MemoryLimit lives
void make_room() noexcept;
}  // namespace memory_limit

// Null when there is no limit. Throws Error when the disk is full.
[[nodiscard]] void* allocate_scratch(std::size_t bytes);
// Whether it was memory from there, which it no longer is.
bool free_scratch(void* memory) noexcept;

// For loops over large arrays, after some hundred steps. Returns when the process is below its limit, or nothing more
// can leave: so the thread that fills memory waits for room, on a busy machine too. Without a limit it does nothing.
inline void make_room() noexcept {
  if (memory_limit::lives.load(std::memory_order_relaxed)) memory_limit::make_room();
}

// Arrays of many megabytes that are read in no order.

// Memory for an array, at a cache line: from huge pages when it is large and the system has them, which saves most of
// the time that address translation and first touches take. Throws std::bad_alloc.
[[nodiscard]] void* allocate_large(std::size_t bytes);
void free_large(void* memory, std::size_t bytes) noexcept;

// While one of these lives, large memory that is given back is kept for the next that asks for no more: a first touch
// of what comes from the system costs more than several passes over it. For any thread.
class LargeMemoryReuse {
 public:
  LargeMemoryReuse() noexcept;
  ~LargeMemoryReuse();
  LargeMemoryReuse(const LargeMemoryReuse&) = delete;
  LargeMemoryReuse& operator=(const LargeMemoryReuse&) = delete;
};

template <typename T>
struct LargeAllocator {
  using value_type = T;
  LargeAllocator() = default;
  template <typename U>
  LargeAllocator(const LargeAllocator<U>& /*other*/) noexcept {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(allocate_large(count * sizeof(T)));
  }
  void deallocate(T* memory, std::size_t count) noexcept { free_large(memory, count * sizeof(T)); }

  friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }
};

template <typename T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

// Leaves new elements without a value where none is given.
template <typename T>
struct UninitializedAllocator : LargeAllocator<T> {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
  using value_type = T;
  UninitializedAllocator() = default;
  template <typename U>
  UninitializedAllocator(const UninitializedAllocator<U>& /*other*/) noexcept {}  // NOLINT(google-explicit-constructor)

  template <typename U>
  void construct(U* /*element*/) noexcept {}
  template <typename U, typename... Values>
  void construct(U* element, Values&&... values) {
    ::new (static_cast<void*>(element)) U(std::forward<Values>(values)...);
  }

  friend bool operator==(const UninitializedAllocator&, const UninitializedAllocator&) { return true; }
};

// For arrays that several threads fill: resize() does not touch new elements, which then have to be written first.
template <typename T>
using UninitializedVector = std::vector<T, UninitializedAllocator<T>>;

// One value per split of a hierarchy that may be larger than any view of it.

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
