// Where an object may be placed, and arithmetic about it that does not lose digits.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <limits>

namespace occlod {

// Throws Error when `object_to_world` is not finite, not affine or cannot be inverted.
void require_placement(const glm::dmat4& object_to_world);

// Bounds of the largest factor by which the linear map stretches a vector: the square root of the infinity norm of M^T
// M, which is at least its largest eigenvalue; exact for rotations times a uniform scale.
[[nodiscard]] double stretch_of(const glm::dmat3& m);

[[nodiscard]] double determinant_of(const glm::dmat3& m);

// x with m * x = y, by Cramer's rule. Where m stretches by s in one direction and 1 / s in another, cofactors as
// glm::inverse computes them are off by s^2 units in the last place of the largest.
[[nodiscard]] glm::dvec3 solve(const glm::dmat3& m, const glm::dvec3& y);

// At least x, and hardly more.
inline float rounded_up(double x) noexcept {
  return static_cast<float>(x * (1.0 + 2e-7)) + std::numeric_limits<float>::denorm_min();
}

}  // namespace occlod
