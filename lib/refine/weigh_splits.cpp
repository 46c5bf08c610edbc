#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "base/platform.h"
#include "occlod/hierarchy.h"
#include "refine/weigh.h"

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refine/weigh_splits.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "refine/bounds_lanes-inl.h"
#include "splits/packed_bounds.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {
namespace {

struct ConeLanes {
  Vec3<Floats> axis;
  hn::Vec<Floats> cos_angle;
};

HWY_INLINE hn::Vec<Floats> low_half(hn::Vec<Ints> pair) {
  return hn::ConvertTo(Floats(), hn::And(pair, hn::Set(Ints(), 0xFFFF)));
}
HWY_INLINE hn::Vec<Floats> high_half(hn::Vec<Ints> pair) {
  return hn::ConvertTo(Floats(), hn::And(hn::ShiftRight<16>(pair), hn::Set(Ints(), 0xFFFF)));
}

// Reads PackedBounds::cone() of each node by the same operations.
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

// Weighs the first nodes, in whole vectors, and returns their number.
std::size_t weigh_vectors(std::span<const SplitNode> nodes, const ObjectView& view, bool tests_cones, float* scales) {
  const std::size_t lanes = hn::Lanes(Doubles());
  HWY_ALIGN std::array<float, hn::MaxLanes(Floats())> seen;
  LaneBits outside, facing_away;
  std::size_t i = 0;
  for (; i + lanes <= nodes.size(); i += lanes) {
    const NodeLanes<SplitNode> node(&nodes[i], hn::Iota(Ints(), 0));
    const Vec3<Floats> center = node.read3(offsetof(SplitNode, sphere));
    const hn::Vec<Floats> radius = node.read(offsetof(SplitNode, sphere) + offsetof(Sphere, radius));
    hn::StoreMaskBits(Floats(), is_outside(center, radius, view).is_so, outside.bytes.data());
    if (tests_cones) {
      const ConeLanes cone = read_cones(node);
      hn::StoreMaskBits(
          Doubles(),
          is_facing_away(wide(center), wide(radius), wide(cone.axis), wide(cone.cos_angle), view.eye()).is_so,
          facing_away.bytes.data());
    }
    hn::Store(scale_px(wide(center), wide(radius), view).scale_px, Floats(), seen.data());
    for (std::size_t lane = 0; lane < lanes; ++lane)
      scales[i + lane] = outside[lane] ? scale_outside : facing_away[lane] ? scale_facing_away : seen[lane];
  }
  return i;
}

}  // namespace
}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {
namespace {

HWY_EXPORT(weigh_vectors);

}  // namespace

void weigh_splits(std::span<const SplitNode> nodes, const ObjectView& view, bool tests_cones,
                  std::span<float> scales_px) {
  assert(scales_px.size() >= nodes.size());
  for (std::size_t i = HWY_DYNAMIC_DISPATCH(weigh_vectors)(nodes, view, tests_cones, scales_px.data());
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

void weigh_splits(const Hierarchy& hierarchy, std::span<const SplitId> splits, const ObjectView& view, bool tests_cones,
                  std::span<float> scales_px) {
  constexpr std::size_t batch_size = 32, lanes = 8;  // lanes is a multiple of the lanes of a vector
  std::array<SplitNode, batch_size> nodes;
  std::array<float, batch_size> scales;
  for (std::size_t first = 0; first < splits.size(); first += batch_size) {
    const std::span<const SplitId> batch = splits.subspan(first, std::min(batch_size, splits.size() - first));
    for (const SplitId s : batch) {
      hierarchy.require(s);
      if (s != no_id) prefetch(&hierarchy.node(s));
    }
    for (std::size_t i = 0; i < batch.size(); ++i)
      if (batch[i] != no_id) nodes[i] = hierarchy.node(batch[i]);
    // The last vector is weighed as a whole: whatever is in the rest of it does no harm.
    const std::size_t weighed = (batch.size() + lanes - 1) / lanes * lanes;
    weigh_splits(std::span(nodes.data(), weighed), view, tests_cones, scales);
    std::copy_n(scales.begin(), batch.size(), scales_px.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

}  // namespace occlod
#endif  // HWY_ONCE
