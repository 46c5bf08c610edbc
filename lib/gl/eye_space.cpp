#include "gl/eye_space.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>

#include "base/placement.h"

namespace occlod::gl {
namespace {

// Pixels are square, so one factor serves both directions.
glm::dvec2 view_scale(const View& view) {
  return 2.0 * view.focal_length_px() / glm::dvec2(view.width(), view.height());
}

glm::dmat3 world_to_view(const View& view) {
  const glm::dvec3 right = glm::normalize(glm::dvec3(glm::row(view.world_to_clip(), 0)));
  const glm::dvec3 up = glm::normalize(glm::dvec3(glm::row(view.world_to_clip(), 1)));
  return glm::transpose(glm::dmat3(right, up, -view.direction()));
}

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

glm::dmat4 view_to_clip(const View& view) {
  const double near = view.camera().near;
  const double far = view.camera().far;
  const glm::dvec2 scale = view_scale(view);
  glm::dmat4 matrix(0.0);
  matrix[0].x = scale.x;
  matrix[1].y = scale.y;
  if (view.is_orthographic()) {
    matrix[2].z = -2.0 / (far - near);
    matrix[3].z = -(far + near) / (far - near);
    matrix[3].w = 1.0;
  } else {
    matrix[2].z = -(far + near) / (far - near);
    matrix[3].z = -2.0 * far * near / (far - near);
    matrix[2].w = -1.0;
  }
  return matrix;
}

EyeSpace::EyeSpace(const View& view, const glm::dmat4& object_to_world) {
  require_placement(object_to_world);
  const glm::dmat3 linear(object_to_world);
  const glm::dmat3 turn = world_to_view(view);
  // Far from the origin the difference of two places is rounded once, and little; their images under a matrix are not.
  const glm::dvec3 origin = glm::dvec3(object_to_world[3]) - view.camera().eye;
  eye = glm::vec3(glm::inverse(linear) * -origin);
  if (!finite(eye)) eye = glm::vec3(0.0F);
  to_view = glm::mat3(turn * linear);
  offset = glm::vec3(turn * (linear * glm::dvec3(eye) + origin));
  glm::dmat4 object_to_view(turn * linear);
  object_to_view[3] = glm::dvec4(turn * origin, 1.0);
  object_to_clip = view_to_clip(view) * object_to_view;
  mirrored = glm::determinant(linear) < 0.0;
}

}  // namespace occlod::gl
