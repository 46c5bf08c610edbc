#include "base/placement.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "occlod/core/error.h"

namespace occlod {
namespace {

bool finite(const glm::dmat4& m) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(m[column][row])) return false;
  return true;
}

// a * b - c * d to 1.5 units in the last place (Kahan; Jeannerod, Louvet & Muller 2013): std::fma rounds once.
double difference_of_products(double a, double b, double c, double d) noexcept {
  const double cd = c * d;
  return std::fma(a, b, -cd) - std::fma(c, d, -cd);
}

glm::dvec3 accurate_cross(const glm::dvec3& a, const glm::dvec3& b) noexcept {
  return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
          difference_of_products(a.x, b.y, a.y, b.x)};
}

}  // namespace

double stretch_of(const glm::dmat3& m) {
  const glm::dmat3 square = glm::transpose(m) * m;
  double largest = 0.0;
  for (int column = 0; column < 3; ++column) {
    const glm::dvec3 c = glm::abs(square[column]);
    largest = std::max(largest, c.x + c.y + c.z);
  }
  return std::sqrt(largest);
}

double determinant_of(const glm::dmat3& m) { return glm::dot(m[0], accurate_cross(m[1], m[2])); }

glm::dvec3 solve(const glm::dmat3& m, const glm::dvec3& y) {
  const glm::dvec3 yz = accurate_cross(m[1], m[2]), zx = accurate_cross(m[2], m[0]), xy = accurate_cross(m[0], m[1]);
  return glm::dvec3(glm::dot(yz, y), glm::dot(zx, y), glm::dot(xy, y)) / determinant_of(m);
}

void require_placement(const glm::dmat4& object_to_world) {
  const double determinant = determinant_of(glm::dmat3(object_to_world));
  if (!finite(object_to_world) || glm::row(object_to_world, 3) != glm::dvec4(0, 0, 0, 1) ||
      !std::isfinite(determinant) || determinant == 0.0)
    throw Error({"object", "transform", "is not an affine matrix with an inverse",
                 "give finite numbers, last row 0 0 0 1, and no zero scale"});
}

}  // namespace occlod
