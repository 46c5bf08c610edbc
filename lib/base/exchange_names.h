// Two names of a file system swapped.
#pragma once

namespace occlod {

// Gives each of two files or folders the other's name, at once. False where the system or the file system cannot.
[[nodiscard]] bool exchange_names(const char* a, const char* b) noexcept;

}  // namespace occlod
