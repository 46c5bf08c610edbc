#include "splits/packed_bounds.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace occlod {

static_assert(sizeof(SplitNode) == 64, "one cache line");

namespace {

constexpr double steps = 65535.0;

float down(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) <= x ? f : std::nextafter(f, std::numeric_limits<float>::lowest());
}
float up(double x) { return -down(-x); }

// Returns step q of the range [middle - half, middle + half], before rounding to single precision.
double step_of(double middle, double half, std::uint16_t q) { return middle + (2.0 * q / steps - 1.0) * half; }
// Returns step q of [0, end].
double step_of(double end, std::uint16_t q) { return end * (q / steps); }

float unpack_cos(std::uint16_t cone_cos) {
  return cone_cos == 0 ? -1.0F : static_cast<float>(cone_cos) * static_cast<float>(1.0 / steps);
}

// Truncates, because steps are not negative.
std::uint16_t clamped(double q) { return static_cast<std::uint16_t>(std::clamp(q, 0.0, steps)); }

// Returns where x lies in the range, in steps. The rounding error is far below step_slack: either differences of
// single-precision numbers are exact in double precision, or the range is smaller than the last place of the unpacked
// value.
double steps_to(double middle, double half, float x) {
  return ((static_cast<double>(x) - middle) / half + 1.0) * (0.5 * steps);
}
constexpr double step_slack = 1e-6;

// Returns the last step that unpacks to at most x, or the one before it.
std::uint16_t pack_down(double middle, double half, float x) {
  const std::uint16_t q = half > 0.0 ? clamped(steps_to(middle, half, x) - step_slack) : std::uint16_t{0};
  assert(down(step_of(middle, half, q)) <= x);
  return q;
}
// Returns the first step that unpacks to at least x, or the one after it.
std::uint16_t pack_up(double middle, double half, float x) {
  const std::uint16_t q = half > 0.0 ? clamped(steps_to(middle, half, x) + step_slack + 1.0) : std::uint16_t{65535};
  assert(up(step_of(middle, half, q)) >= x);
  return q;
}

}  // namespace

// Encodes the direction octahedrally: projects it onto |x| + |y| + |z| = 1, whose lower half is folded over the
// diagonals (Meyer et al. 2010, "On floating-point normal vectors").
void PackedBounds::set_axis(const glm::vec3& direction) {
  const glm::dvec3 n =
      glm::dvec3(direction) / (std::abs(static_cast<double>(direction.x)) + std::abs(static_cast<double>(direction.y)) +
                               std::abs(static_cast<double>(direction.z)));
  double x = n.x, y = n.y;
  if (n.z < 0.0) {
    x = std::copysign(1.0 - std::abs(n.y), n.x);
    y = std::copysign(1.0 - std::abs(n.x), n.y);
  }
  const auto pack = [](double coordinate) { return clamped((coordinate + 1.0) * 0.5 * steps + 0.5); };
  axis = {pack(x), pack(y)};
}

glm::vec3 PackedBounds::unpack_axis() const noexcept {
  constexpr float scale = 2.0F / 65535.0F;
  glm::vec3 n(static_cast<float>(axis[0]) * scale - 1.0F, static_cast<float>(axis[1]) * scale - 1.0F, 0.0F);
  n.z = 1.0F - std::abs(n.x) - std::abs(n.y);
  const float fold = std::max(-n.z, 0.0F);
  n.x -= std::copysign(fold, n.x);
  n.y -= std::copysign(fold, n.y);
  return glm::normalize(n);
}

void PackedBounds::set_cone(float cos_angle) {
  if (!(cos_angle > 0.0F)) {
    cone_cos = 0;
    return;
  }
  cone_cos = clamped(static_cast<double>(cos_angle) * steps);
  if (cone_cos > 0 && unpack_cos(cone_cos) > cos_angle) --cone_cos;  // unpacking rounds as well
}

NormalCone PackedBounds::cone() const noexcept { return {unpack_axis(), unpack_cos(cone_cos)}; }

void PackedBounds::set_cylinder(const Sphere& sphere, const Cylinder& cylinder) {
  const double r = static_cast<double>(sphere.radius);
  cylinder_radius =
      r > 0.0 ? clamped(static_cast<double>(cylinder.radius) / r * steps + step_slack + 1.0) : std::uint16_t{0};
  assert(up(step_of(r, cylinder_radius)) >= cylinder.radius);
  cylinder_t = {pack_down(0.0, r, cylinder.t_min), pack_up(0.0, r, cylinder.t_max)};
}

Cylinder PackedBounds::cylinder(const Sphere& sphere) const noexcept {
  const double r = static_cast<double>(sphere.radius);
  return {sphere.center, up(step_of(r, cylinder_radius)), unpack_axis(), down(step_of(0.0, r, cylinder_t[0])),
          up(step_of(0.0, r, cylinder_t[1]))};
}

void PackedBounds::set_box(const Sphere& sphere, const Box& box) {
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double middle = static_cast<double>(sphere.center[i]), half = static_cast<double>(sphere.radius);
    box_min[k] = pack_down(middle, half, box.min[i]);
    box_max[k] = pack_up(middle, half, box.max[i]);
  }
}

Box PackedBounds::box(const Sphere& sphere) const noexcept {
  Box box;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double middle = static_cast<double>(sphere.center[i]), half = static_cast<double>(sphere.radius);
    box.min[i] = down(step_of(middle, half, box_min[k]));
    box.max[i] = up(step_of(middle, half, box_max[k]));
  }
  return box;
}

NormalCone SplitNode::cone() const noexcept { return packed_bounds(*this).cone(); }
Cylinder SplitNode::cylinder() const noexcept { return packed_bounds(*this).cylinder(sphere); }
Box SplitNode::box() const noexcept { return packed_bounds(*this).box(sphere); }

}  // namespace occlod
