// Large memory in files, while a MemoryLimit lives.
#pragma once

#include <atomic>
#include <cstddef>

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

}  // namespace occlod
