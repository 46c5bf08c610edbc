// Between sRGB, in which files and meshes have the colours of vertices, and linear light (IEC 61966-2-1).
#pragma once

#include <algorithm>
#include <cmath>

namespace occlod {

// Both take and give values in [0, 1]; others are clamped and NaN is 0.
[[nodiscard]] inline double srgb_to_linear(double encoded) noexcept {
  const double v = encoded > 0.0 ? std::min(encoded, 1.0) : 0.0;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}
[[nodiscard]] inline double linear_to_srgb(double linear) noexcept {
  const double v = linear > 0.0 ? std::min(linear, 1.0) : 0.0;
  return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
}

}  // namespace occlod
