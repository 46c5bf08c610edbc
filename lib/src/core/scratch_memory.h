// Large memory in files, while a MemoryLimit lives.
#pragma once

#include <cstddef>

namespace occlod {

// Null when there is no limit. Throws Error when the disk is full.
[[nodiscard]] void* allocate_scratch(std::size_t bytes);
// Whether it was memory from there, which it no longer is.
bool free_scratch(void* memory) noexcept;

}  // namespace occlod
