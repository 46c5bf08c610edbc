// Between object units and units in which a mesh is about 1 wide, so that squares and their products stay in range.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

#include "occlod/math/bounds.h"

namespace occlod {

// The power of two, exact to multiply with, that takes the extent of the positions into [1/2, 1]; within 2^-126 and
// 2^126, so that it has an inverse.
[[nodiscard]] inline float power_of_two_scale(std::span<const glm::vec3> positions) {
  const Box box = bounding_box(positions);
  const glm::dvec3 size = glm::dvec3(box.max) - glm::dvec3(box.min);
  int exponent = 0;
  (void)std::frexp(std::max({size.x, size.y, size.z}), &exponent);
  return std::ldexp(1.0F, -std::clamp(exponent, -126, 126));
}

// length * factor, never less where the product is denormal.
[[nodiscard]] inline float scaled_up(float length, float factor) {
  const float product = length * factor;
  const bool may_be_less = product < std::numeric_limits<float>::min() && length > 0.0F;
  return may_be_less ? std::nextafter(product, 1.0F) : product;
}

}  // namespace occlod
