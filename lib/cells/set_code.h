// Sets of numbers in few bits: runs, whose gaps and lengths are each coded in the way that is shortest for them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cells/bit_stream.h"

namespace occlod {

// Ways to code a sequence of numbers; the tag, 4 bits, stands before them. 0 to 13: Rice codes, of which the tag is how
// many bits of a number are written as they are, after the rest in unary. (Golomb 1966, Rice 1979; Elias 1975.)
inline constexpr unsigned rice_codes = 14, gamma_tag = 14, varint_tag = 15;

// Numbers < 2^40. The way that takes the fewest bits, that with the smallest tag among equals. O(numbers * codes).
void put_numbers(BitWriter& writer, std::span<const std::uint64_t> numbers);
// So many numbers. False when there are not so many, or one is >= 2^40.
[[nodiscard]] bool get_numbers(BitReader& reader, std::size_t count, std::vector<std::uint64_t>& numbers);

// Ascending, different, < 2^40. The number of runs, then gaps, then lengths.
void put_set(BitWriter& writer, std::span<const std::uint64_t> set);
// Appends a set of numbers < end to `set`. False when it is damaged, reaches beyond `end`, or has more than `most`
// elements; then `set` has been given at most those.
[[nodiscard]] bool get_set(BitReader& reader, std::uint64_t end, std::size_t most, std::vector<std::uint64_t>& set);

}  // namespace occlod
