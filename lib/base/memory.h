// Memory for large arrays: in scratch files while a MemoryLimit lives, from huge pages otherwise.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace occlod {

namespace memory_limit {
inline std::atomic<bool> lives = false;  // true while a MemoryLimit lives
void make_room() noexcept;
}  // namespace memory_limit

// Returns memory in a scratch file, or null when there is no limit. Throws Error when the disk is full.
[[nodiscard]] void* allocate_scratch(std::size_t bytes);
// Frees memory from allocate_scratch(). Returns false, and does nothing, for any other memory.
bool free_scratch(void* memory) noexcept;

// From now on the pages of a file that is mapped for reading leave main memory, too, when those of scratch files do.
void let_leave(std::span<const std::byte> mapped_file);
// The reverse, before it is unmapped.
void keep(std::span<const std::byte> mapped_file) noexcept;

// Waits until the process is below its MemoryLimit or no more pages can leave main memory. Loops over large arrays call
// it every few hundred steps, so that the thread that fills memory waits for room, even on a busy machine. Does nothing
// without a limit.
inline void make_room() noexcept {
  if (memory_limit::lives.load(std::memory_order_relaxed)) memory_limit::make_room();
}

// Allocates memory for an array, aligned to a cache line. Large arrays get huge pages where the system has them, which
// saves most of the time of address translation and of first touches when an array is read in no order. Throws
// std::bad_alloc.
[[nodiscard]] void* allocate_large(std::size_t bytes);
void free_large(void* memory, std::size_t bytes) noexcept;

// While one of these lives, freed large blocks are kept and given to the next request that is no larger: the first
// touch of new memory from the system costs more than several passes over it. Works for all threads.
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

  // NOLINTBEGIN(bugprone-sizeof-expression): T may be a pointer
  [[nodiscard]] T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(allocate_large(count * sizeof(T)));
  }
  void deallocate(T* memory, std::size_t count) noexcept { free_large(memory, count * sizeof(T)); }
  // NOLINTEND(bugprone-sizeof-expression)

  friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }
};

template <typename T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

// Leaves new elements uninitialised unless a value is given.
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

// A vector for arrays that several threads fill: resize() does not touch new elements, which must be written before
// they are read.
template <typename T>
using UninitializedVector = std::vector<T, UninitializedAllocator<T>>;

template <typename T>
using ZeroedArray = std::unique_ptr<T[], decltype(&std::free)>;

// Returns an array of zeros from calloc(): pages that are never touched are never allocated, so an array with one value
// per split of a large hierarchy costs only what is used. Throws std::bad_alloc.
template <typename T>
[[nodiscard]] ZeroedArray<T> zeroed_array(std::size_t count) {
  static_assert(std::is_trivial_v<T>);
  void* const memory = std::calloc(std::max<std::size_t>(count, 1), sizeof(T));
  if (memory == nullptr) throw std::bad_alloc();
  return {static_cast<T*>(memory), &std::free};
}

}  // namespace occlod
