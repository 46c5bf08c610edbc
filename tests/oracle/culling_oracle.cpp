#include "oracle/culling_oracle.h"

#include <cmath>
#include <glm/trigonometric.hpp>

namespace occlod::test {
namespace {

using Number = CullingOracle::Number;
using Vector = CullingOracle::Vector;
using Point = CullingOracle::Point;

constexpr double margin = 1e-12;  // far above the error of a tangent of 89.5 degrees, 200 units in the last place

Vector vector(const glm::dvec3& v) { return {Number(v.x), Number(v.y), Number(v.z)}; }
Point point(const glm::vec3& p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}

double length(const Vector& v) { return std::sqrt(CGAL::to_double(v.squared_length())); }

// Evaluated once, instead of anew in every predicate.
Number settled(const Number& n) { return Number(CGAL::exact(n)); }
Vector settled(const Vector& v) { return {settled(v.x()), settled(v.y()), settled(v.z())}; }

}  // namespace

CullingOracle::CullingOracle(const Camera& camera, const glm::dmat4& object_to_world)
    : parallel_(camera.orthographic_height.has_value()) {
  for (int row = 0; row < 3; ++row)
    rows_[static_cast<std::size_t>(row)] =
        vector({object_to_world[0][row], object_to_world[1][row], object_to_world[2][row]});
  from_eye_ = settled(vector(glm::dvec3(object_to_world[3])) - vector(camera.eye));
  ahead_ = settled(vector(camera.target) - vector(camera.eye));
  right_ = settled(CGAL::cross_product(ahead_, vector(camera.up)));
  up_ = settled(CGAL::cross_product(right_, ahead_));

  const double half = parallel_ ? *camera.orthographic_height / 2.0 : std::tan(glm::radians(camera.fov_y_deg) / 2.0);
  const double aspect = static_cast<double>(camera.width) / camera.height;
  focal_length_px_ = Number(camera.height / 2.0 / half * (1.0 - margin));
  const double one = length(ahead_);
  // What the image shows to the left (-1) or right (1), at distance 1 or at any; likewise below and above. Off-centre
  // it may be less than nothing.
  const auto shown = [&](int axis, int side) {
    const double principal = camera.principal_point[axis];
    const double halves = 1.0 - side * principal - margin * (1.0 + std::abs(principal));
    return Number(half * (axis == 0 ? aspect : 1.0) * halves * length(axis == 0 ? right_ : up_));
  };
  const auto side_plane = [&](int axis, int side) {
    const Vector inwards = Number(-side) * (axis == 0 ? right_ : up_);
    if (parallel_) return plane(inwards, shown(axis, side));
    return plane(shown(axis, side) / Number(one) * ahead_ + inwards, Number(0));
  };
  planes_ = {side_plane(0, -1),
             side_plane(0, 1),
             side_plane(1, -1),
             side_plane(1, 1),
             plane(ahead_, Number(-camera.near * one * (1.0 + margin))),
             plane(-ahead_, Number(camera.far * one * (1.0 - margin)))};

  to_eye_ = settled(to_object(parallel_ ? -ahead_ : -from_eye_));
}

// Cramer's rule for rows * x = v.
Vector CullingOracle::to_object(const Vector& v) const {
  const auto& [r0, r1, r2] = rows_;
  const Vector c12 = CGAL::cross_product(r1, r2), c20 = CGAL::cross_product(r2, r0), c01 = CGAL::cross_product(r0, r1);
  return (v.x() * c12 + v.y() * c20 + v.z() * c01) / (r0 * c12);
}

Vector CullingOracle::to_world(const Vector& v) const { return {rows_[0] * v, rows_[1] * v, rows_[2] * v}; }

CullingOracle::Plane CullingOracle::plane(const Vector& normal, const Number& offset) const {
  return {settled(normal.x() * rows_[0] + normal.y() * rows_[1] + normal.z() * rows_[2]),
          settled(normal * from_eye_ + offset)};
}

std::uint32_t CullingOracle::planes_outside(const glm::vec3& p) const {
  const Vector v = point(p) - Point(0, 0, 0);
  std::uint32_t outside = 0;
  for (std::size_t i = 0; i < planes_.size(); ++i)
    if (planes_[i].normal * v + planes_[i].offset < 0) outside |= 1U << i;
  return outside;
}

bool CullingOracle::faces_eye(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) const {
  const Point from = parallel_ ? point(a) : Point(0, 0, 0);
  return CGAL::orientation(point(a), point(b), point(c), from + to_eye_) == CGAL::POSITIVE;
}

// The picture of d is at F (d.right / |right|, d.up / |up|) / (d.ahead / |ahead|). Its derivative along v has the
// square F^2 |ahead|^2 (x^2 / |right|^2 + y^2 / |up|^2) / z^4 with x, y, z as below. Where rays are parallel nothing is
// divided by d.ahead / |ahead|.
bool CullingOracle::moves_more_than(float scale_px, const glm::vec3& p, const glm::vec3& displacement) const {
  const Vector step = point(displacement) - Point(0, 0, 0);
  const Vector d = to_world(point(p) - Point(0, 0, 0)) + from_eye_, v = to_world(step);
  const Number scale(static_cast<double>(scale_px));
  if (parallel_) {
    const Number x = v * right_, y = v * up_;
    const Number pixels =
        focal_length_px_ * focal_length_px_ * (x * x / right_.squared_length() + y * y / up_.squared_length());
    return pixels > scale * scale * step.squared_length();
  }
  const Number z = d * ahead_, change = v * ahead_;
  const Number x = (v * right_) * z - (d * right_) * change, y = (v * up_) * z - (d * up_) * change;
  const Number pixels = focal_length_px_ * focal_length_px_ * ahead_.squared_length() *
                        (x * x / right_.squared_length() + y * y / up_.squared_length());
  return pixels > scale * scale * step.squared_length() * z * z * z * z;
}

}  // namespace occlod::test
