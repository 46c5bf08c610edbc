// Arithmetic for the generators: only +, -, *, / and sqrt on doubles, which IEEE 754 fixes to the bit, so that the same
// options give the same bytes under every C++ library. (The build switches contraction to fused multiply-add off.)
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

namespace occlod {

// sin(t * pi / 2) for t in [0, 1]: the Taylor polynomial of degree 15, absolute error below 1e-11.
[[nodiscard]] inline double sine_of_quarter_turns(double t) noexcept {
  constexpr double half_pi = 1.57079632679489661923;
  const double x = half_pi * t;
  const double x2 = x * x;
  double sum = 1.0;
  for (int k = 15; k >= 3; k -= 2) sum = 1.0 - sum * x2 / (k * (k - 1));
  return x * sum;
}

// Corner `corner` of the regular polygon with `corners` corners on the unit circle, counter-clockwise from (1, 0).
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

  // Below `bound`, which is small against 2^64 and not 0.
  [[nodiscard]] int below(int bound) noexcept { return static_cast<int>(next() % static_cast<std::uint64_t>(bound)); }
  // In [low, high).
  [[nodiscard]] double between(double low, double high) noexcept {
    return low + (high - low) * (static_cast<double>(next() >> 11) * 0x1p-53);
  }

 private:
  [[nodiscard]] std::uint64_t next() noexcept { return scatter(state_ += 0x9e3779b97f4a7c15ULL); }

  std::uint64_t state_;
};

}  // namespace occlod
