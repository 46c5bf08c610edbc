#include "refine/weigh_nodes.h"

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "math/facing_slack.h"
#include "math/inverse_power_of_two.h"

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refine/weigh_nodes.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::ScalableTag<double>;
using Floats = hn::Rebind<float, Doubles>;
using Ints = hn::Rebind<std::int32_t, Doubles>;

// Lanes of floats or of doubles.
template <typename Tag>
struct Vec3 {
  hn::Vec<Tag> x, y, z;
};

HWY_INLINE hn::Vec<Floats> constant(float value) { return hn::Set(Floats(), value); }
HWY_INLINE hn::Vec<Doubles> constant(double value) { return hn::Set(Doubles(), value); }
HWY_INLINE Vec3<Doubles> constant(const glm::dvec3& v) { return {constant(v.x), constant(v.y), constant(v.z)}; }

HWY_INLINE hn::Vec<Doubles> wide(hn::Vec<Floats> v) { return hn::PromoteTo(Doubles(), v); }
HWY_INLINE Vec3<Doubles> wide(const Vec3<Floats>& v) { return {wide(v.x), wide(v.y), wide(v.z)}; }

HWY_INLINE Vec3<Doubles> subtract(const Vec3<Doubles>& a, const Vec3<Doubles>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vec3<Doubles> scale(hn::Vec<Doubles> s, const Vec3<Doubles>& v) {
  return {hn::Mul(s, v.x), hn::Mul(s, v.y), hn::Mul(s, v.z)};
}
HWY_INLINE hn::Vec<Doubles> dot(const Vec3<Doubles>& a, const Vec3<Doubles>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE hn::Vec<Doubles> length(const Vec3<Doubles>& v) { return hn::Sqrt(dot(v, v)); }

// The members of nodes that are read, a vector each: nodes of either kind are one cache line and begin with a sphere.
template <typename Node>
class NodeLanes {
 public:
  HWY_INLINE explicit NodeLanes(const Node* first)
      : first_(&first->sphere.center.x),
        places_(hn::Mul(hn::Iota(Ints(), 0), hn::Set(Ints(), sizeof(Node) / sizeof(float)))) {}

  HWY_INLINE hn::Vec<Floats> read(std::size_t offset) const {
    return hn::GatherIndex(Floats(), first_ + offset / sizeof(float), places_);
  }
  HWY_INLINE Vec3<Floats> read3(std::size_t offset) const {
    return {read(offset), read(offset + sizeof(float)), read(offset + 2 * sizeof(float))};
  }
  // Two 16-bit numbers, the first of which is in the lower half.
  HWY_INLINE hn::Vec<Ints> read_pair(std::size_t offset) const { return hn::BitCast(Ints(), read(offset)); }

 private:
  const float* first_;
  hn::Vec<Ints> places_;
};

struct ConeLanes {
  Vec3<Floats> axis;
  hn::Vec<Floats> cos_angle;
};

HWY_INLINE ConeLanes read_cones(const NodeLanes<FrontNode>& nodes) {
  return {nodes.read3(offsetof(FrontNode, cone)),
          nodes.read(offsetof(FrontNode, cone) + offsetof(NormalCone, cos_angle))};
}

HWY_INLINE hn::Vec<Floats> low_half(hn::Vec<Ints> pair) {
  return hn::ConvertTo(Floats(), hn::And(pair, hn::Set(Ints(), 0xFFFF)));
}
HWY_INLINE hn::Vec<Floats> high_half(hn::Vec<Ints> pair) {
  return hn::ConvertTo(Floats(), hn::And(hn::ShiftRight<16>(pair), hn::Set(Ints(), 0xFFFF)));
}

// As PackedBounds::cone, operation by operation.
HWY_INLINE ConeLanes read_cones(const NodeLanes<SplitNode>& nodes) {
  constexpr float step = 2.0F / 65535.0F;
  const hn::Vec<Floats> one = constant(1.0F), zero = constant(0.0F);
  const hn::Vec<Ints> axis = nodes.read_pair(offsetof(SplitNode, bounds) + offsetof(PackedBounds, axis));
  hn::Vec<Floats> x = hn::Sub(hn::Mul(low_half(axis), constant(step)), one);
  hn::Vec<Floats> y = hn::Sub(hn::Mul(high_half(axis), constant(step)), one);
  const hn::Vec<Floats> z = hn::Sub(hn::Sub(one, hn::Abs(x)), hn::Abs(y));
  const hn::Vec<Floats> fold = hn::Max(hn::Neg(z), zero);
  x = hn::Sub(x, hn::CopySign(fold, x));
  y = hn::Sub(y, hn::CopySign(fold, y));
  const hn::Vec<Floats> square = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
  const hn::Vec<Floats> scale = hn::Div(one, hn::Sqrt(square));
  const hn::Vec<Floats> cone_cos =
      low_half(nodes.read_pair(offsetof(SplitNode, bounds) + offsetof(PackedBounds, cone_cos)));
  const hn::Vec<Floats> cos_angle = hn::IfThenElse(hn::Eq(cone_cos, zero), constant(-1.0F),
                                                   hn::Mul(cone_cos, constant(static_cast<float>(1.0 / 65535.0))));
  return {{hn::Mul(x, scale), hn::Mul(y, scale), hn::Mul(z, scale)}, cos_angle};
}

// As ObjectView::may_be_inside, operation by operation.
HWY_INLINE hn::Mask<Floats> is_outside(const Vec3<Floats>& center, hn::Vec<Floats> radius, const ObjectView& view) {
  hn::Mask<Floats> outside = hn::Ne(radius, radius);
  for (const glm::vec4& plane : view.planes()) {
    const hn::Vec<Floats> x = hn::Mul(constant(plane.x), center.x), y = hn::Mul(constant(plane.y), center.y),
                          z = hn::Mul(constant(plane.z), center.z), w = constant(plane.w);
    const hn::Vec<Floats> reach = hn::Add(hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), hn::Abs(z)), hn::Abs(w));
    const hn::Vec<Floats> slack = hn::Mul(constant(1e-6F), hn::Add(reach, radius));
    const hn::Vec<Floats> distance = hn::Add(hn::Add(hn::Add(x, y), z), w);
    outside = hn::Or(outside, hn::Lt(distance, hn::Neg(hn::Add(radius, slack))));
  }
  return outside;
}

// As faces_away.
HWY_INLINE hn::Mask<Doubles> is_facing_away(const Vec3<Doubles>& center, hn::Vec<Doubles> radius,
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
  return hn::And(hn::And(hn::Gt(cos_angle, zero), hn::Gt(along, zero)), hn::Gt(smallest, hn::Add(radius, slack)));
}

// As ObjectView::largest_scale_px.
HWY_INLINE hn::Vec<Floats> scale_px(const Vec3<Doubles>& center_in_object, hn::Vec<Doubles> object_radius,
                                    const ObjectView& view) {
  const hn::Vec<Doubles> one = constant(1.0);
  const glm::dmat4x3& m = view.object_to_eye();
  const auto row = [&](int r) {
    return hn::Add(
        hn::Add(hn::Add(hn::Mul(constant(m[0][r]), center_in_object.x), hn::Mul(constant(m[1][r]), center_in_object.y)),
                hn::Mul(constant(m[2][r]), center_in_object.z)),
        constant(m[3][r]));
  };
  const Vec3<Doubles> center = {row(0), row(1), row(2)};
  const hn::Vec<Doubles> radius = hn::Mul(object_radius, constant(view.largest_stretch()));
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
  const hn::Vec<Doubles> seen =
      hn::IfThenElse(hn::Gt(nearest, hn::Zero(Doubles())), result, constant(std::numeric_limits<double>::infinity()));
  // Rounded up.
  return hn::Add(hn::DemoteTo(Floats(), hn::Mul(seen, constant(1.0 + 2e-7))),
                 constant(std::numeric_limits<float>::denorm_min()));
}

// Calls put(i, outside, facing_away, scale_px) for each of the first nodes; returns how many: whole vectors.
template <typename Node, typename Put>
HWY_INLINE std::size_t weigh_vectors(std::span<const Node> nodes, const ObjectView& view, bool tests_cones,
                                     const Put& put) {
  constexpr std::size_t bytes_of_mask = 8;  // at least, for any number of lanes
  const std::size_t lanes = hn::Lanes(Doubles());
  HWY_ALIGN std::array<float, hn::MaxLanes(Floats())> scales;
  std::array<std::uint8_t, bytes_of_mask> outside{}, facing_away{};
  std::size_t i = 0;
  for (; i + lanes <= nodes.size(); i += lanes) {
    const NodeLanes<Node> node(&nodes[i]);
    const Vec3<Floats> center = node.read3(offsetof(Node, sphere));
    const hn::Vec<Floats> radius = node.read(offsetof(Node, sphere) + offsetof(Sphere, radius));
    hn::StoreMaskBits(Floats(), is_outside(center, radius, view), outside.data());
    if (tests_cones) {
      const ConeLanes cone = read_cones(node);
      hn::StoreMaskBits(Doubles(),
                        is_facing_away(wide(center), wide(radius), wide(cone.axis), wide(cone.cos_angle), view.eye()),
                        facing_away.data());
    }
    hn::Store(scale_px(wide(center), wide(radius), view), Floats(), scales.data());
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const auto is_set = [&](const auto& bits) { return (bits[lane / 8] >> (lane % 8) & 1U) != 0; };
      put(i + lane, is_set(outside), is_set(facing_away), scales[lane]);
    }
  }
  return i;
}

std::size_t weigh_front(std::span<FrontNode> nodes, const ObjectView& view, bool tests_cones, WeighedNodes& counts) {
  return weigh_vectors(std::span<const FrontNode>(nodes), view, tests_cones,
                       [&](std::size_t i, bool out, bool faces_away, float scale) {
                         const bool away = !out && faces_away;
                         counts.outside += out ? 1 : 0;
                         counts.facing_away += away ? 1 : 0;
                         nodes[i].scale_px = out || away ? 0.0F : scale;
                       });
}

std::size_t weigh_some_splits(std::span<const SplitNode> nodes, const ObjectView& view, bool tests_cones,
                              float* scales) {
  return weigh_vectors(nodes, view, tests_cones, [&](std::size_t i, bool out, bool away, float scale) {
    scales[i] = out ? scale_outside : away ? scale_facing_away : scale;
  });
}

}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {
namespace {

HWY_EXPORT(weigh_front);
HWY_EXPORT(weigh_some_splits);

}  // namespace

WeighedNodes weigh_nodes(std::span<FrontNode> nodes, const ObjectView& view, bool tests_cones) {
  WeighedNodes counts;
  for (std::size_t i = HWY_DYNAMIC_DISPATCH(weigh_front)(nodes, view, tests_cones, counts); i < nodes.size(); ++i)
    nodes[i].scale_px = scale_px_of(nodes[i], view, tests_cones, counts);
  return counts;
}

void weigh_splits(std::span<const SplitNode> nodes, const ObjectView& view, bool tests_cones,
                  std::span<float> scales_px) {
  assert(scales_px.size() >= nodes.size());
  for (std::size_t i = HWY_DYNAMIC_DISPATCH(weigh_some_splits)(nodes, view, tests_cones, scales_px.data());
       i < nodes.size(); ++i) {
    const SplitNode& node = nodes[i];
    if (!view.may_be_inside(node.sphere))
      scales_px[i] = scale_outside;
    else if (tests_cones && faces_away(node.cone(), node.sphere, view.eye()))
      scales_px[i] = scale_facing_away;
    else
      scales_px[i] = view.largest_scale_px(node.sphere);
  }
}

float scale_px_of(const FrontNode& node, const ObjectView& view, bool tests_cones, WeighedNodes& counts) {
  if (!view.may_be_inside(node.sphere)) {
    ++counts.outside;
    return 0.0F;
  }
  if (tests_cones && faces_away(node.cone, node.sphere, view.eye())) {
    ++counts.facing_away;
    return 0.0F;
  }
  return view.largest_scale_px(node.sphere);
}

}  // namespace occlod
#endif  // HWY_ONCE
