// From object space to clip space for depth buffers.
#pragma once

#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "occlod/view/view.h"

namespace occlod {

// ObjectView's own matrix is single-precision. Close to the eye and far from the object's origin its rows for z and w
// cancel, and each by itself is wrong by 2^-24 of what cancels: z / w by many steps of a depth buffer, differently for
// each object. Here z is what it must be for that w, z = a w + b, so that what is left of the error moves a depth by no
// larger part than w's. An orthographic z is kept: it is off by 2^-24 of the distance from the object's origin.
[[nodiscard]] inline glm::dmat4 clip_matrix(const Camera& camera, const ObjectView& object) {
  const double a = (camera.far + camera.near) / (camera.far - camera.near);
  const double b = -2.0 * camera.far * camera.near / (camera.far - camera.near);
  glm::dmat4 matrix(object.object_to_clip());
  if (object.is_orthographic()) return matrix;
  for (int column = 0; column < 4; ++column) matrix[column].z = a * matrix[column].w;
  matrix[3].z += b;
  return matrix;
}

[[nodiscard]] inline std::vector<glm::dmat4> clip_matrices(const Camera& camera, std::span<const ObjectView> objects) {
  std::vector<glm::dmat4> matrices;
  matrices.reserve(objects.size());
  for (const ObjectView& object : objects) matrices.push_back(clip_matrix(camera, object));
  return matrices;
}

}  // namespace occlod
