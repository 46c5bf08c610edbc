// Tests the bounds of nodes in a view, one node per lane, for every instruction set.
#if defined(OCCLOD_PRIORITY_BOUNDS_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef OCCLOD_PRIORITY_BOUNDS_LANES_INL_H_
#undef OCCLOD_PRIORITY_BOUNDS_LANES_INL_H_
#else
#define OCCLOD_PRIORITY_BOUNDS_LANES_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>

#include "base/arithmetic.h"
#include "hwy/highway.h"
#include "occlod/view.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::ScalableTag<double>;
using Floats = hn::Rebind<float, Doubles>;
using Ints = hn::Rebind<std::int32_t, Doubles>;

// Holds vectors of floats or of doubles.
template <typename Tag>
struct Vec3 {
  hn::Vec<Tag> x, y, z;
};

HWY_INLINE hn::Vec<Floats> constant(float value) { return hn::Set(Floats(), value); }
HWY_INLINE hn::Vec<Doubles> constant(double value) { return hn::Set(Doubles(), value); }
HWY_INLINE Vec3<Doubles> constant(const glm::dvec3& v) { return {constant(v.x), constant(v.y), constant(v.z)}; }

HWY_INLINE hn::Vec<Doubles> wide(hn::Vec<Floats> v) { return hn::PromoteTo(Doubles(), v); }
HWY_INLINE Vec3<Doubles> wide(const Vec3<Floats>& v) { return {wide(v.x), wide(v.y), wide(v.z)}; }

// Converts like static_cast<float>. Highway's plain C++ would turn infinity into the largest float.
HWY_INLINE hn::Vec<Floats> narrow(hn::Vec<Doubles> v) {
  const hn::Vec<Floats> result = hn::DemoteTo(Floats(), v);
  const hn::Mask<Floats> is_infinite = hn::Ge(hn::Abs(result), constant(std::numeric_limits<float>::max()));
  return hn::IfThenElse(is_infinite, hn::CopySign(constant(std::numeric_limits<float>::infinity()), result), result);
}

template <typename Tag>
HWY_INLINE Vec3<Tag> subtract(const Vec3<Tag>& a, const Vec3<Tag>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vec3<Doubles> scale(hn::Vec<Doubles> s, const Vec3<Doubles>& v) {
  return {hn::Mul(s, v.x), hn::Mul(s, v.y), hn::Mul(s, v.z)};
}
template <typename Tag>
HWY_INLINE hn::Vec<Tag> dot(const Vec3<Tag>& a, const Vec3<Tag>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE hn::Vec<Doubles> length(const Vec3<Doubles>& v) { return hn::Sqrt(dot(v, v)); }

// Reads one member of several nodes into a vector. Nodes of either kind are one cache line and begin with a sphere.
template <typename Node>
class NodeLanes {
 public:
  HWY_INLINE NodeLanes(const Node* first, hn::Vec<Ints> which)
      : first_(&first->sphere.center.x), places_(hn::Mul(which, hn::Set(Ints(), sizeof(Node) / sizeof(float)))) {}

  HWY_INLINE hn::Vec<Floats> read(std::size_t offset) const {
    return hn::GatherIndex(Floats(), first_ + offset / sizeof(float), places_);
  }
  HWY_INLINE Vec3<Floats> read3(std::size_t offset) const {
    return {read(offset), read(offset + sizeof(float)), read(offset + 2 * sizeof(float))};
  }
  // Reads two 16-bit numbers, the first of which is in the lower half.
  HWY_INLINE hn::Vec<Ints> read_pair(std::size_t offset) const { return hn::BitCast(Ints(), read(offset)); }

 private:
  const float* first_;
  hn::Vec<Ints> places_;
};

HWY_INLINE hn::Vec<Doubles> infinite() { return constant(std::numeric_limits<double>::infinity()); }

// Holds whether something is so, and how far the eye may move, or the center of the sphere relative to planes, before
// that can change.
template <typename Tag>
struct Verdict {
  hn::Mask<Tag> is_so;
  hn::Vec<Tag> margin;
};

// Returns the opposite of ObjectView::may_be_inside(), computed by the same operations.
HWY_INLINE Verdict<Floats> is_outside(const Vec3<Floats>& center, hn::Vec<Floats> radius, const ObjectView& view) {
  hn::Vec<Floats> inside = constant(std::numeric_limits<float>::infinity()), rounding = hn::Zero(Floats());
  for (const glm::vec4& plane : view.planes()) {
    const hn::Vec<Floats> x = hn::Mul(constant(plane.x), center.x), y = hn::Mul(constant(plane.y), center.y),
                          z = hn::Mul(constant(plane.z), center.z), w = constant(plane.w);
    const hn::Vec<Floats> reach = hn::Add(hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), hn::Abs(z)), hn::Abs(w));
    const hn::Vec<Floats> slack = hn::Mul(constant(1e-6F), hn::Add(reach, radius));
    const hn::Vec<Floats> distance = hn::Add(hn::Add(hn::Add(x, y), z), w);
    const hn::Vec<Floats> inward = hn::Add(distance, hn::Add(radius, slack));
    inside = hn::IfThenElse(hn::Lt(inward, inside), inward, inside);  // NaN counts as inside
    rounding = hn::Max(rounding, hn::Mul(constant(4.0F), slack));
  }
  return {hn::Lt(inside, hn::Zero(Floats())), hn::Sub(hn::Abs(inside), rounding)};
}

// Returns the result of faces_away(). Both quantities that it compares change by no more than the eye moves.
HWY_INLINE Verdict<Doubles> is_facing_away(const Vec3<Doubles>& center, hn::Vec<Doubles> radius,
                                           const Vec3<Doubles>& axis, hn::Vec<Doubles> cos_angle,
                                           const glm::vec3& eye) {
  const hn::Vec<Doubles> zero = hn::Zero(Doubles()), one = constant(1.0);
  const Vec3<Doubles> d = subtract(center, constant(glm::dvec3(eye)));
  const hn::Vec<Doubles> along = dot(d, axis);
  const hn::Vec<Doubles> across = length(subtract(d, scale(along, axis)));
  const hn::Vec<Doubles> sin_angle = hn::Sqrt(hn::Mul(hn::Sub(one, cos_angle), hn::Add(one, cos_angle)));
  const hn::Vec<Doubles> smallest = hn::Sub(hn::Mul(along, cos_angle), hn::Mul(across, sin_angle));
  const hn::Vec<Doubles> slack = hn::Add(hn::Mul(constant(facing_slack), hn::Add(along, across)),
                                         constant(eye_slack * static_cast<double>(largest_coordinate(eye))));
  const hn::Mask<Doubles> has_cone = hn::Gt(cos_angle, zero);
  const hn::Mask<Doubles> away =
      hn::And(hn::And(has_cone, hn::Gt(along, zero)), hn::Gt(smallest, hn::Add(radius, slack)));
  const hn::Vec<Doubles> beyond = hn::Sub(smallest, hn::Add(radius, slack));
  const hn::Vec<Doubles> nearer = hn::Min(along, beyond);  // for no change, both must stay positive, or one of them
                                                           // negative
  const hn::Vec<Doubles> rounding = hn::Mul(constant(4.0), hn::Abs(slack));
  return {away, hn::IfThenElse(has_cone, hn::Sub(hn::Abs(nearer), rounding), infinite())};
}

// Holds the scale in pixels per object unit, and the distance of the nearest point of the sphere and its radius, which
// bound its growth, in world units. `nearest` is 0 in orthographic views, where the scale does not depend on it.
struct ScaleLanes {
  hn::Vec<Floats> scale_px, nearest, radius;
};

// Returns the result of ObjectView::largest_scale_px() and what it depends on.
HWY_INLINE ScaleLanes scale_px(const Vec3<Doubles>& center_in_object, hn::Vec<Doubles> object_radius,
                               const ObjectView& view) {
  const hn::Vec<Doubles> radius = hn::Mul(object_radius, constant(view.largest_stretch()));
  if (view.is_orthographic()) return {hn::Set(Floats(), view.largest_scale_px({})), hn::Zero(Floats()), narrow(radius)};
  const hn::Vec<Doubles> one = constant(1.0);
  const glm::dmat4x3& m = view.object_to_eye();
  const auto row = [&](int r) HWY_ATTR {
    return hn::Add(
        hn::Add(hn::Add(hn::Mul(constant(m[0][r]), center_in_object.x), hn::Mul(constant(m[1][r]), center_in_object.y)),
                hn::Mul(constant(m[2][r]), center_in_object.z)),
        constant(m[3][r]));
  };
  const Vec3<Doubles> center = {row(0), row(1), row(2)};
  const hn::Vec<Doubles> distance = length(center);
  const hn::Vec<Doubles> nearest = hn::Sub(distance, radius);
  const hn::Vec<Doubles> cos_center =
      hn::Min(hn::Max(hn::Div(dot(center, constant(view.direction())), distance), constant(-1.0)), one);
  const hn::Vec<Doubles> sin_center = hn::Sqrt(hn::Sub(one, hn::Mul(cos_center, cos_center)));
  const hn::Vec<Doubles> sin_radius = hn::Div(radius, distance);
  const hn::Vec<Doubles> cos_radius = hn::Sqrt(hn::Sub(one, hn::Mul(sin_radius, sin_radius)));
  const hn::Vec<Doubles> cos_largest = hn::Max(
      constant(view.cos_corner_angle()), hn::Sub(hn::Mul(cos_center, cos_radius), hn::Mul(sin_center, sin_radius)));
  const hn::Vec<Doubles> result = hn::Div(constant(view.focal_length_px() * view.largest_stretch()),
                                          hn::Mul(hn::Mul(nearest, cos_largest), cos_largest));
  const hn::Mask<Doubles> is_before = hn::Gt(nearest, hn::Zero(Doubles()));
  const hn::Vec<Doubles> seen = hn::IfThenElse(is_before, result, infinite());
  // The scale is rounded up.
  return {hn::Add(narrow(hn::Mul(seen, constant(1.0 + 2e-7))), constant(std::numeric_limits<float>::denorm_min())),
          narrow(nearest), narrow(radius)};
}

}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // OCCLOD_PRIORITY_BOUNDS_LANES_INL_H_, once for each instruction set
