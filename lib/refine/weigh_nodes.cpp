#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

#include "base/arithmetic.h"
#include "refine/weigh.h"

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refine/weigh_nodes.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "refine/bounds_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {
namespace {

// Bounds the relative change of a scale per unit of displacement, up to displacements of `motion_limit`.
struct ScaleGrowth {
  hn::Vec<Floats> per_motion, motion_limit;
};

// Bounds the growth of f / (nearest * cos^2 a). While the eye goes no farther than a quarter of the way to the sphere,
// ln(1 / nearest) grows by at most 1 / nearest for each unit, and ln(cos^-2 a) by 2 tan a for each radian. The angle a
// is the sum of the angle to the center and half of that under which the sphere is seen; these grow by 1 / distance
// each, the latter divided by the cosine of that half. What grows exponentially to twice its size lies below the chord.
HWY_INLINE ScaleGrowth error_growth_of(const ScaleLanes& scale, const ObjectView& view) {
  const hn::Vec<Floats> one = constant(1.0F), zero = hn::Zero(Floats());
  const auto stretch = static_cast<float>(view.largest_stretch());
  const hn::Vec<Floats> nearest = hn::Mul(constant(0.75F), scale.nearest);
  const hn::Vec<Floats> distance = hn::Add(nearest, scale.radius);
  const hn::Vec<Floats> widening = hn::Div(scale.radius, hn::Sqrt(hn::Mul(nearest, hn::Add(distance, scale.radius))));
  const hn::Vec<Floats> angle = hn::Div(hn::Add(one, widening), distance);
  const hn::Vec<Floats> steepness = constant(static_cast<float>(2.0 * tan_corner_angle(view)));
  const hn::Vec<Floats> rate = hn::Mul(constant(stretch), hn::Add(hn::Div(one, nearest), hn::Mul(steepness, angle)));
  const hn::Vec<Floats> motion_limit =
      hn::Min(hn::Div(constant(std::numbers::ln2_v<float>), rate), hn::Mul(constant(0.25F / stretch), scale.nearest));
  const hn::Mask<Floats> is_before = hn::Gt(scale.nearest, zero);
  return {hn::IfThenElseZero(is_before, hn::Div(constant(1.001F), motion_limit)),
          hn::IfThenElse(is_before, motion_limit, hn::Mul(constant(-1.0F / stretch), scale.nearest))};
}

// Weighs one vector of nodes.
HWY_INLINE void weigh_vector(Front& front, const std::int32_t* which, const WeighingView& now) {
  const NodeLanes<FrontNode> node(&front.node(0), hn::LoadU(Ints(), which));
  const Vec3<Floats> center = node.read3(offsetof(FrontNode, sphere));
  const hn::Vec<Floats> radius = node.read(offsetof(FrontNode, sphere) + offsetof(Sphere, radius));
  const Verdict<Floats> outside = is_outside(center, radius, now.view);
  const hn::Mask<Doubles> is_out = hn::Gt(wide(hn::IfThenElseZero(outside.is_so, constant(1.0F))), hn::Zero(Doubles()));
  const ScaleLanes scale = scale_px(wide(center), wide(radius), now.view);
  const ScaleGrowth growth = error_growth_of(scale, now.view);
  const auto from = [&](const glm::vec3& p) HWY_ATTR {
    const hn::Vec<Floats> x = hn::Sub(center.x, constant(p.x)), y = hn::Sub(center.y, constant(p.y)),
                          z = hn::Sub(center.z, constant(p.z));
    return hn::Sqrt(hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
  };
  constexpr auto rounding = static_cast<float>(4.0 * eye_slack);
  const hn::Vec<Floats> from_eye =
      hn::Add(from(now.view.eye()), constant(rounding * largest_coordinate(now.view.eye())));
  const hn::Vec<Floats> from_center = hn::Add(from(now.center), constant(rounding * largest_coordinate(now.center)));
  const hn::Vec<Floats> reach =
      hn::IfThenElse(hn::Lt(hn::Mul(constant(2.0F), from_center), from_eye), hn::Neg(from_center),
                     hn::Add(hn::Mul(constant(1.25F), from_eye), radius));
  hn::Vec<Floats> motion_limit = hn::Min(outside.margin, hn::Add(hn::Mul(constant(0.25F), from_eye), radius));
  hn::Vec<Floats> eye_distance_limit = constant(std::numeric_limits<float>::infinity());
  hn::Mask<Doubles> is_away = hn::Lt(hn::Zero(Doubles()), hn::Zero(Doubles()));
  if (now.tests_cones) {
    const Vec3<Doubles> axis = wide(node.read3(offsetof(FrontNode, cone)));
    const hn::Vec<Doubles> cos_angle = wide(node.read(offsetof(FrontNode, cone) + offsetof(NormalCone, cos_angle)));
    const Verdict<Doubles> away = is_facing_away(wide(center), wide(radius), axis, cos_angle, now.view.eye());
    is_away = hn::AndNot(is_out, away.is_so);
    eye_distance_limit = hn::IfThenElse(outside.is_so, eye_distance_limit, narrow(away.margin));
  }
  const hn::Mask<Doubles> is_seen = hn::Not(hn::Or(is_out, is_away));
  const hn::Mask<Floats> seen =
      hn::Gt(hn::DemoteTo(Floats(), hn::IfThenElseZero(is_seen, constant(1.0))), hn::Zero(Floats()));
  motion_limit = hn::IfThenElse(seen, hn::Min(motion_limit, growth.motion_limit), motion_limit);
  WeighedLanes results;
  const auto rounded_down = [](hn::Vec<Floats> of) HWY_ATTR {
    return hn::IfThenElseZero(hn::Gt(of, hn::Zero(Floats())), hn::Mul(constant(0.999F), of));
  };
  hn::Store(scale.scale_px, Floats(), results.scale_px.data());
  hn::Store(hn::IfThenElseZero(seen, growth.per_motion), Floats(), results.per_motion.data());
  hn::Store(rounded_down(motion_limit), Floats(), results.motion_limit.data());
  hn::Store(rounded_down(eye_distance_limit), Floats(), results.eye_distance_limit.data());
  hn::Store(hn::Mul(constant(1.0F + 1e-6F), reach), Floats(), results.radius.data());
  hn::StoreMaskBits(Doubles(), is_out, results.outside.bytes.data());
  hn::StoreMaskBits(Doubles(), is_away, results.facing_away.bytes.data());
  for (std::size_t lane = 0; lane < hn::Lanes(Doubles()); ++lane)
    results.give(lane, front, static_cast<Front::Index>(which[lane]), now);
}

void weigh_vectors(Front& front, std::span<const Front::Index> which, const WeighingView& now) {
  const std::size_t lanes = hn::Lanes(Doubles());
  HWY_ALIGN std::array<std::int32_t, hn::MaxLanes(Floats())> vector;
  for (std::size_t i = 0; i < which.size(); i += lanes) {
    // The last vector is filled up with the last node.
    for (std::size_t lane = 0; lane < lanes; ++lane)
      vector[lane] = static_cast<std::int32_t>(which[std::min(i + lane, which.size() - 1)]);
    weigh_vector(front, vector.data(), now);
  }
}

}  // namespace
}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {
namespace {

HWY_EXPORT(weigh_vectors);

}  // namespace

void weigh_nodes(Front& front, std::span<const Front::Index> which, const WeighingView& now) {
  if (!which.empty()) HWY_DYNAMIC_DISPATCH(weigh_vectors)(front, which, now);
}

}  // namespace occlod
#endif  // HWY_ONCE
