// Adaptive Huffman coding of lists of numbers, which Chhugani and others 2003 (sec. 2.4) use for long deltas: no table
// of frequencies is stored.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "papers/bit_string.h"

namespace occlod::paper {

// By the algorithm of Faller, Gallager and Knuth (Knuth 1985); a number that comes for the first time follows in Elias
// gamma. Numbers >= 1. O(bits).
[[nodiscard]] BitString encode_adaptive(std::span<const std::uint32_t> numbers);
// Of bits that encode_adaptive() gave.
[[nodiscard]] std::vector<std::uint32_t> decode_adaptive(const BitString& bits);

}  // namespace occlod::paper
