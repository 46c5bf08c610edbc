// Converts linear light to the values that a file stores.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace occlod::picture {

// Follows IEC 61966-2-1.
inline std::uint8_t to_srgb(float linear) {
  const float v = std::clamp(linear, 0.0F, 1.0F);
  const float encoded = v <= 0.0031308F ? 12.92F * v : 1.055F * std::pow(v, 1.0F / 2.4F) - 0.055F;
  return static_cast<std::uint8_t>(std::lround(255.0F * encoded));
}

inline glm::u8vec4 to_srgb(const glm::vec3& linear) {
  return {to_srgb(linear.x), to_srgb(linear.y), to_srgb(linear.z), 255};
}

inline float to_linear(std::uint8_t srgb) {
  const float v = static_cast<float>(srgb) / 255.0F;
  return v <= 0.04045F ? v / 12.92F : std::pow((v + 0.055F) / 1.055F, 2.4F);
}

inline glm::vec3 to_linear(const glm::u8vec4& srgb) {
  return {to_linear(srgb.x), to_linear(srgb.y), to_linear(srgb.z)};
}

}  // namespace occlod::picture
