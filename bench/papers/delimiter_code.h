// The delimiter code of Chhugani and others 2003, sec. 2.4, repaired.
//
// Each number is written in binary from its first 1, with `11` between numbers; inside a number every `11`, from left
// to right and without overlap, becomes `110`; and a number that ends in `01` gets another `1`. As printed that is
// ambiguous: (5, 3) and (2, 1, 2) both give 101111110. Its rules for reading imply that a lone `1` is doubled as well,
// and so it is here.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "papers/bit_string.h"

namespace occlod::paper {

// Numbers >= 1. O(bits).
[[nodiscard]] BitString encode_delimited(std::span<const std::uint32_t> numbers);
// Of bits that encode_delimited() gave. Decided by the length of each run of ones. O(bits).
[[nodiscard]] std::vector<std::uint32_t> decode_delimited(const BitString& bits);

}  // namespace occlod::paper
