#include "refine/weigh_nodes.h"

#include <array>
#include <cstddef>
#include <limits>

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refine/weigh_nodes.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using Vec = hn::Vec<Floats>;
using Mask = hn::Mask<Floats>;

HWY_INLINE Vec constant(float value) { return hn::Set(Floats(), value); }

struct Vec3 {
  Vec x, y, z;
};

HWY_INLINE Vec3 constant(const glm::vec3& v) { return {constant(v.x), constant(v.y), constant(v.z)}; }
HWY_INLINE Vec3 subtract(const Vec3& a, const Vec3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vec dot(const Vec3& a, const Vec3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vec root(Vec square) { return hn::Sqrt(hn::Max(square, hn::Zero(Floats()))); }

// The members of FrontNode that are read, a vector each: all nodes are one cache line.
class NodeLanes {
 public:
  HWY_INLINE explicit NodeLanes(const FrontNode* first)
      : first_(&first->sphere.center.x),
        places_(hn::Mul(hn::Iota(Ints(), 0), hn::Set(Ints(), sizeof(FrontNode) / sizeof(float)))) {}

  HWY_INLINE Vec read(std::size_t offset) const {
    return hn::GatherIndex(Floats(), first_ + offset / sizeof(float), places_);
  }
  HWY_INLINE Vec3 read3(std::size_t offset) const {
    return {read(offset), read(offset + sizeof(float)), read(offset + 2 * sizeof(float))};
  }

 private:
  const float* first_;
  hn::Vec<Ints> places_;
};

// As ObjectView::may_be_inside, operation by operation.
HWY_INLINE Mask is_outside(const Vec3& center, Vec radius, const ObjectView& view) {
  Mask outside = hn::Lt(radius, radius);
  for (const glm::vec4& plane : view.planes()) {
    const Vec3 terms = {hn::Mul(constant(plane.x), center.x), hn::Mul(constant(plane.y), center.y),
                        hn::Mul(constant(plane.z), center.z)};
    const Vec reach =
        hn::Add(hn::Add(hn::Add(hn::Abs(terms.x), hn::Abs(terms.y)), hn::Abs(terms.z)), hn::Abs(constant(plane.w)));
    const Vec slack = hn::Mul(constant(1e-6F), hn::Add(reach, radius));
    const Vec distance = hn::Add(hn::Add(hn::Add(terms.x, terms.y), terms.z), constant(plane.w));
    outside = hn::Or(outside, hn::Lt(distance, hn::Neg(hn::Add(radius, slack))));
  }
  return outside;
}

// As faces_away.
HWY_INLINE Mask is_facing_away(const Vec3& center, Vec radius, const Vec3& axis, Vec cos_angle,
                               const ObjectView& view) {
  const Vec zero = hn::Zero(Floats()), one = constant(1.0F);
  const Vec3 d = subtract(center, constant(view.eye()));
  const Vec along = dot(d, axis);
  const Vec across = root(hn::Sub(dot(d, d), hn::Mul(along, along)));
  const Vec sin_angle = root(hn::Mul(hn::Sub(one, cos_angle), hn::Add(one, cos_angle)));
  const Vec smallest = hn::Sub(hn::Mul(along, cos_angle), hn::Mul(across, sin_angle));
  const Vec slack = hn::Mul(constant(1e-5F), hn::Add(hn::Add(along, across), radius));
  return hn::And(hn::And(hn::Gt(cos_angle, zero), hn::Gt(along, zero)), hn::Gt(smallest, hn::Add(radius, slack)));
}

// As ObjectView::largest_scale_px.
HWY_INLINE Vec scale_px(const Vec3& center_in_object, Vec object_radius, const ObjectView& view) {
  const Vec one = constant(1.0F);
  const glm::mat4x3& m = view.object_to_eye();
  const auto row = [&](int r) {
    return hn::Add(
        hn::Add(hn::Add(hn::Mul(constant(m[0][r]), center_in_object.x), hn::Mul(constant(m[1][r]), center_in_object.y)),
                hn::Mul(constant(m[2][r]), center_in_object.z)),
        constant(m[3][r]));
  };
  const Vec3 center = {row(0), row(1), row(2)};
  const Vec radius = hn::Mul(object_radius, constant(view.largest_stretch()));
  const Vec distance = hn::Sqrt(dot(center, center));
  const Vec nearest = hn::Sub(distance, radius);
  const Vec cos_center =
      hn::Min(hn::Max(hn::Div(dot(center, constant(view.direction())), distance), constant(-1.0F)), one);
  const Vec sin_center = root(hn::Sub(one, hn::Mul(cos_center, cos_center)));
  const Vec sin_radius = hn::Min(one, hn::Div(radius, distance));
  const Vec cos_radius = hn::Sqrt(hn::Sub(one, hn::Mul(sin_radius, sin_radius)));
  const Vec cos_largest = hn::Max(constant(view.cos_corner_angle()),
                                  hn::Sub(hn::Mul(cos_center, cos_radius), hn::Mul(sin_center, sin_radius)));
  const Vec scale = hn::Div(constant(view.focal_length_px() * view.largest_stretch()),
                            hn::Mul(hn::Mul(nearest, cos_largest), cos_largest));
  return hn::IfThenElse(hn::Gt(nearest, hn::Zero(Floats())), scale, constant(std::numeric_limits<float>::infinity()));
}

// Returns how many of the first nodes have been weighed: whole vectors.
std::size_t weigh_vectors(std::span<FrontNode> nodes, const ObjectView& view, bool two_sided, WeighedNodes& counts) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  HWY_ALIGN std::array<float, hn::MaxLanes(Floats())> scales;
  std::size_t i = 0;
  for (; i + lanes <= nodes.size(); i += lanes) {
    const NodeLanes node(&nodes[i]);
    const Vec3 center = node.read3(offsetof(FrontNode, sphere));
    const Vec radius = node.read(offsetof(FrontNode, sphere) + offsetof(Sphere, radius));
    const Mask outside = is_outside(center, radius, view);
    Mask hidden = outside;
    if (!two_sided) {
      const Vec3 axis = node.read3(offsetof(FrontNode, cone));
      const Vec cos_angle = node.read(offsetof(FrontNode, cone) + offsetof(NormalCone, cos_angle));
      hidden = hn::Or(hidden, is_facing_away(center, radius, axis, cos_angle, view));
    }
    const std::size_t outside_count = hn::CountTrue(d, outside);
    counts.outside += outside_count;
    counts.facing_away += hn::CountTrue(d, hidden) - outside_count;
    hn::Store(hn::IfThenElse(hidden, hn::Zero(d), scale_px(center, radius, view)), d, scales.data());
    for (std::size_t lane = 0; lane < lanes; ++lane) nodes[i + lane].scale_px = scales[lane];
  }
  return i;
}

}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {
namespace {

HWY_EXPORT(weigh_vectors);

}  // namespace

WeighedNodes weigh_nodes(std::span<FrontNode> nodes, const ObjectView& view, bool two_sided) {
  WeighedNodes counts;
  for (std::size_t i = HWY_DYNAMIC_DISPATCH(weigh_vectors)(nodes, view, two_sided, counts); i < nodes.size(); ++i)
    nodes[i].scale_px = scale_px_of(nodes[i], view, two_sided, counts);
  return counts;
}

float scale_px_of(const FrontNode& node, const ObjectView& view, bool two_sided, WeighedNodes& counts) {
  if (!view.may_be_inside(node.sphere)) {
    ++counts.outside;
    return 0.0F;
  }
  if (!two_sided && faces_away(node.cone, node.sphere, view.eye())) {
    ++counts.facing_away;
    return 0.0F;
  }
  return view.largest_scale_px(node.sphere);
}

}  // namespace occlod
#endif  // HWY_ONCE
