// Floating-point helpers. First: bounds on the rounding error of the test whether a normal cone faces away.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "occlod/bounds.h"

namespace occlod {

constexpr double facing_slack = 1e-6;  // relative to the lengths: the axis is a unit vector of floats
constexpr double eye_slack = 1.2e-7;   // relative to the eye's largest coordinate: the eye was rounded to floats

// These functions scale lengths to near 1, so that products of several of them stay in the range of floats. Multiplying
// by a power of two is exact, so results computed from scaled lengths are the same, bit by bit, at every size.

// Returns 2^-e where 2^e <= length < 2^(e + 1), clamped to [2^-126, 2^126] so that its inverse is a float too. `length`
// is not negative.
inline float inverse_power_of_two(float length) noexcept {
  constexpr int mantissa_bits = 23;
  constexpr std::uint32_t least = 1, most = 253;  // biased exponents; 127 is that of 1
  const std::uint32_t exponent = std::clamp(std::bit_cast<std::uint32_t>(length) >> mantissa_bits, least, most);
  return std::bit_cast<float>((2 * 127 - exponent) << mantissa_bits);
}

// True when `length` is in [2^-20, 2^20]. Areas computed from such lengths, and the squares of those areas that are at
// least 2^-20 of the largest that the length allows, stay in the range of floats without scaling.
inline bool is_near_one(float length) noexcept { return length >= 0x1p-20F && length <= 0x1p20F; }

inline float largest_coordinate(const glm::vec3& p) noexcept {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

// Returns inverse_power_of_two() of the largest coordinate of `v`.
inline float inverse_power_of_two(const glm::vec3& v) noexcept { return inverse_power_of_two(largest_coordinate(v)); }

// The generators use only +, -, *, / and sqrt on doubles, which IEEE 754 fixes to the bit, so that the same options
// give the same bytes with every C++ library. (The build switches off contraction to fused multiply-add.)

// Returns sin(t * pi / 2) for t in [0, 1], by the Taylor polynomial of degree 15; the absolute error is below 1e-11.
[[nodiscard]] inline double sine_of_quarter_turns(double t) noexcept {
  constexpr double half_pi = 1.57079632679489661923;
  const double x = half_pi * t;
  const double x2 = x * x;
  double sum = 1.0;
  for (int k = 15; k >= 3; k -= 2) sum = 1.0 - sum * x2 / (k * (k - 1));
  return x * sum;
}

// Returns corner `corner` of the regular polygon with `corners` corners on the unit circle, counter-clockwise from (1,
// 0).
[[nodiscard]] inline glm::dvec2 unit_circle_corner(int corner, int corners) noexcept {
  const std::int64_t quarters = std::int64_t{4} * (corner % corners);
  const double t = static_cast<double>(quarters % corners) / corners;
  const double s = sine_of_quarter_turns(t);
  const double c = sine_of_quarter_turns(1.0 - t);
  switch (quarters / corners) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

// The finaliser of SplitMix64 (Steele, Lea & Flood 2014): a bijection that scatters neighbouring numbers.
[[nodiscard]] constexpr std::uint64_t scatter(std::uint64_t x) noexcept {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

// The SplitMix64 generator: a seeded stream of evenly distributed numbers.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) noexcept : state_(seed) {}

  // Returns a number in [0, bound). `bound` is small compared with 2^64 and not 0.
  [[nodiscard]] int below(int bound) noexcept { return static_cast<int>(next() % static_cast<std::uint64_t>(bound)); }
  // Returns a number in [low, high).
  [[nodiscard]] double between(double low, double high) noexcept {
    return low + (high - low) * (static_cast<double>(next() >> 11) * 0x1p-53);
  }

 private:
  [[nodiscard]] std::uint64_t next() noexcept { return scatter(state_ += 0x9e3779b97f4a7c15ULL); }

  std::uint64_t state_;
};

// Returns the smallest box that contains both boxes.
[[nodiscard]] inline Box unite(const Box& a, const Box& b) { return {glm::min(a.min, b.min), glm::max(a.max, b.max)}; }

}  // namespace occlod
