#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "occlod/core/error.h"
#include "occlod/view/view.h"

namespace occlod {
namespace {

// Bounds of the largest factor by which the linear map stretches a vector: the square root of the infinity norm of M^T
// M, which is at least its largest eigenvalue; exact for rotations times a uniform scale.
double stretch_of(const glm::dmat3& m) {
  const glm::dmat3 square = glm::transpose(m) * m;
  double largest = 0.0;
  for (int column = 0; column < 3; ++column) {
    const glm::dvec3 c = glm::abs(square[column]);
    largest = std::max(largest, c.x + c.y + c.z);
  }
  return std::sqrt(largest);
}

bool finite(const glm::dmat4& m) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(m[column][row])) return false;
  return true;
}

glm::vec4 unit_plane(const glm::dvec4& plane) { return glm::vec4(plane / glm::length(glm::dvec3(plane))); }

}  // namespace

ObjectView::ObjectView(const View& view, const glm::dmat4& object_to_world) {
  const glm::dmat3 linear(object_to_world);
  const double determinant = glm::determinant(linear);
  if (!finite(object_to_world) || glm::row(object_to_world, 3) != glm::dvec4(0, 0, 0, 1) ||
      !std::isfinite(determinant) || determinant == 0.0)
    throw Error({"object", "transform", "is not an affine matrix with an inverse",
                 "give finite numbers, last row 0 0 0 1, and no zero scale"});
  const glm::dmat4 to_clip = view.world_to_clip() * object_to_world;
  object_to_clip_ = glm::mat4(to_clip);
  const glm::dmat4 world_to_object = glm::inverse(object_to_world);
  eye_ = glm::vec3(world_to_object * glm::dvec4(view.camera().eye, 1.0));
  direction_ = glm::vec3(view.direction());
  glm::dmat4 to_eye = object_to_world;
  to_eye[3] -= glm::dvec4(view.camera().eye, 0.0);
  object_to_eye_ = glm::mat4x3(to_eye);
  largest_stretch_ = static_cast<float>(stretch_of(linear));
  focal_length_px_ = static_cast<float>(view.focal_length_px());
  cos_corner_angle_ = static_cast<float>(view.cos_corner_angle());
  mirrored_ = determinant < 0.0;
  // Gribb & Hartmann: a clip-space plane is a sum of rows of the matrix, already in object space.
  const glm::dvec4 w = glm::row(to_clip, 3);
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec4 row = glm::row(to_clip, axis);
    planes_[static_cast<std::size_t>(2 * axis)] = unit_plane(w + row);
    planes_[static_cast<std::size_t>(2 * axis + 1)] = unit_plane(w - row);
  }
}

bool ObjectView::may_be_inside(const Sphere& sphere) const noexcept {
  return std::all_of(planes_.begin(), planes_.end(), [&](const glm::vec4& plane) {
    const glm::vec3 terms = glm::vec3(plane) * sphere.center;
    const float slack =
        1e-6F * (std::abs(terms.x) + std::abs(terms.y) + std::abs(terms.z) + std::abs(plane.w) + sphere.radius);
    // Written so that NaN counts as inside.
    return !(terms.x + terms.y + terms.z + plane.w < -(sphere.radius + slack));
  });
}

float ObjectView::largest_scale_px(const Sphere& sphere) const noexcept {
  const glm::vec3 center = object_to_eye_ * glm::vec4(sphere.center, 1.0F);
  const float radius = sphere.radius * largest_stretch_;
  const float distance = glm::length(center);
  const float nearest = distance - radius;
  if (!(nearest > 0.0F)) return std::numeric_limits<float>::infinity();
  // A displacement at distance d and angle a from the axis covers at most f / (d cos^2 a) pixels per unit: f / z for
  // the depth z = d cos a, and once more 1 / cos a in the radial direction. The largest angle: that of the centre plus
  // that under which the sphere is seen; the image ends at its corners.
  const float cos_center = std::clamp(glm::dot(center, direction_) / distance, -1.0F, 1.0F);
  const float sin_center = std::sqrt(std::fmax(0.0F, 1.0F - cos_center * cos_center));
  const float sin_radius = std::fmin(1.0F, radius / distance);
  const float cos_radius = std::sqrt(1.0F - sin_radius * sin_radius);
  const float cos_largest = std::fmax(cos_corner_angle_, cos_center * cos_radius - sin_center * sin_radius);
  return focal_length_px_ * largest_stretch_ / (nearest * cos_largest * cos_largest);
}

}  // namespace occlod
