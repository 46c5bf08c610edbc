// Checks where an object is placed, and computes with its transform without losing digits.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <limits>

namespace occlod {

// Throws Error when `object_to_world` is not finite, not affine or cannot be inverted.
void require_placement(const glm::dmat4& object_to_world);

// Returns an upper bound on the largest factor by which the linear map stretches a vector: the square root of the
// infinity norm of M^T M, which is at least its largest eigenvalue. It is exact for rotations times a uniform scale.
[[nodiscard]] double stretch_of(const glm::dmat3& m);

[[nodiscard]] double determinant_of(const glm::dmat3& m);

// Returns x with m * x = y, by Cramer's rule. glm::inverse is not used: where m stretches by s in one direction and by
// 1 / s in another, its cofactors are off by s^2 units in the last place of the largest.
[[nodiscard]] glm::dvec3 solve(const glm::dmat3& m, const glm::dvec3& y);

// Returns a float that is at least x and hardly more.
inline float rounded_up(double x) noexcept {
  return static_cast<float>(x * (1.0 + 2e-7)) + std::numeric_limits<float>::denorm_min();
}

}  // namespace occlod
