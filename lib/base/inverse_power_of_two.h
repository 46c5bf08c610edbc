// Brings lengths near 1, where products of several of them stay in the range of floats. Products with a power of two
// are exact, so what is computed from such lengths is the same, bit by bit, at every size.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>

namespace occlod {

// 2^-e for 2^e <= length < 2^(e + 1), within 2^-126 and 2^126, so that it has an inverse. `length` is not negative.
inline float inverse_power_of_two(float length) noexcept {
  constexpr int mantissa_bits = 23;
  constexpr std::uint32_t least = 1, most = 253;  // biased exponents; 127 is that of 1
  const std::uint32_t exponent = std::clamp(std::bit_cast<std::uint32_t>(length) >> mantissa_bits, least, most);
  return std::bit_cast<float>((2 * 127 - exponent) << mantissa_bits);
}

// Between 2^-20 and 2^20: areas, and the squares of those that are not smaller than 2^-20 of what their length allows,
// are in range as they are.
inline bool is_near_one(float length) noexcept { return length >= 0x1p-20F && length <= 0x1p20F; }

inline float largest_coordinate(const glm::vec3& p) noexcept {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

// By its largest coordinate.
inline float inverse_power_of_two(const glm::vec3& v) noexcept { return inverse_power_of_two(largest_coordinate(v)); }

}  // namespace occlod
