// One number for a whole hierarchy: a change of speed that changes the result is seen at once.
#pragma once

#include <cstdint>

#include "occlod/hierarchy.h"

namespace occlod::bench {

// XXH3 over the bytes and lengths of all arrays.
[[nodiscard]] std::uint64_t hash_of(const Hierarchy& hierarchy);

}  // namespace occlod::bench
