// How much memory a command took.
#pragma once

#include <cstdint>

namespace occlod::tool {

// The most memory that this process has held.
[[nodiscard]] std::uint64_t peak_bytes();

}  // namespace occlod::tool
