// Counts what operator new is asked for. Only for programs with support/counted_allocations.cpp among their sources,
// which replaces it.
#pragma once

#include <cstddef>

namespace occlod::test {

// So far.
[[nodiscard]] std::size_t allocation_count() noexcept;

}  // namespace occlod::test
