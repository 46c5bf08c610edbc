// Measures how much memory a command took.
#pragma once

#include <cstdint>

namespace occlod::tool {

// Returns the most memory that this process has held, in bytes.
[[nodiscard]] std::uint64_t peak_bytes();

}  // namespace occlod::tool
