// Stable radix sort on several threads.
#pragma once

#include <cstdint>

#include "base/large_vector.h"

namespace occlod {

struct Keyed {
  std::uint32_t key;
  std::uint32_t item;
};

// Ascending keys, all below 2^key_bits, equal keys in their old order. The result does not depend on the threads. O(n).
void sort_by_key(UninitializedVector<Keyed>& items, unsigned key_bits, unsigned threads);

}  // namespace occlod
