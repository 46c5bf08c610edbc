// What culling is judged by: the numbers of camera, transform and mesh as they are given, in CGAL's exact arithmetic.
#pragma once

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <array>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "occlod/view.h"

namespace occlod::test {

// Only the tangent of the field of view and the lengths of axes are not rational: the frustum and the focal length are
// taken smaller by 1e-12 of themselves, so that what is inside here is truly inside.
class CullingOracle {
 public:
  using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
  using Number = Kernel::FT;
  using Vector = Kernel::Vector_3;
  using Point = Kernel::Point_3;

  // Precondition: View and ObjectView accept both.
  CullingOracle(const Camera& camera, const glm::dmat4& object_to_world);

  // Bit i: the point, in object space, is outside plane i of left, right, bottom, top, near, far.
  [[nodiscard]] std::uint32_t planes_outside(const glm::vec3& point) const;
  // Whether the eye, or where parallel rays come from, is in front of the plane of the triangle, in object space.
  [[nodiscard]] bool faces_eye(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) const;
  // Whether a small displacement of `point`, which is inside, moves its picture by more than `scale_px` pixels for each
  // object unit.
  [[nodiscard]] bool moves_more_than(float scale_px, const glm::vec3& point, const glm::vec3& displacement) const;

 private:
  struct Plane {
    Vector normal;  // inward, object space; of any length
    Number offset;
  };
  [[nodiscard]] Vector to_world(const Vector& v) const;   // without the translation
  [[nodiscard]] Vector to_object(const Vector& v) const;  // the inverse
  [[nodiscard]] Plane plane(const Vector& normal, const Number& offset) const;

  std::array<Vector, 3> rows_;  // of the linear part of the transform
  Vector from_eye_;             // to the origin of the object, world space
  Vector ahead_, right_, up_;   // orthogonal; of any length
  Number focal_length_px_;
  std::array<Plane, 6> planes_;
  bool parallel_;
  Vector to_eye_;  // object space: from the origin to the eye, or the direction that parallel rays come from
};

}  // namespace occlod::test
