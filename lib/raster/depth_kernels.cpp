#include "raster/depth_kernels.h"

#include <algorithm>

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/depth_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, depth_row_texels / 2>;
using Vec = hn::Vec<Floats>;

// Returns the smaller of each pair of neighbours in `low` and then in `high`.
HWY_INLINE Vec smallest_of_pairs(Vec low, Vec high) {
#if HWY_TARGET == HWY_SCALAR
  return hn::Min(low, high);
#else
  const Floats d;
  return hn::Min(hn::ConcatEven(d, high, low), hn::ConcatOdd(d, high, low));
#endif
}

void reduce_level(const DepthTexels<const float>& below, const DepthLevelView& level, const PixelRect& changed) {
  const Floats d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int y = changed.y0; y < changed.y1; ++y) {
    const float* upper = below.texels + 2 * y * below.stride;
    const float* lower = below.texels + std::min(2 * y + 1, below.height - 1) * below.stride;
    float* out = level.texels + y * level.stride;
    for (int x = changed.x0 & -lanes; x < changed.x1; x += lanes) {
      const Vec low = hn::Min(hn::LoadU(d, upper + 2 * x), hn::LoadU(d, lower + 2 * x));
      const Vec high = hn::Min(hn::LoadU(d, upper + 2 * x + lanes), hn::LoadU(d, lower + 2 * x + lanes));
      hn::StoreU(smallest_of_pairs(low, high), d, out + x);
    }
  }
}

std::uint32_t count_row(const float* texels, int count, float limit) {
  const Floats d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Vec limits = hn::Set(d, limit);
  std::size_t found = 0;
  int x = 0;
  for (; x + lanes <= count; x += lanes) found += hn::CountTrue(d, hn::Le(hn::LoadU(d, texels + x), limits));
  for (; x < count; ++x) found += texels[x] <= limit ? 1 : 0;
  return static_cast<std::uint32_t>(found);
}

using Lanes = hn::CappedTag<std::int32_t, bounds_batch_size>;
using FloatLanes = hn::Rebind<float, Lanes>;
using IntVec = hn::Vec<Lanes>;
using FloatVec = hn::Vec<FloatLanes>;

// The range of texels [low, high], at most three, that pixels [begin, end) meet along one axis.
struct TexelLanes {
  HWY_INLINE TexelLanes(IntVec begin, IntVec end, IntVec level, IntVec last)
      : low(hn::Min(hn::Shr(begin, level), last)),
        high(hn::Max(hn::Shr(hn::Max(hn::Sub(end, hn::Set(Lanes(), 1)), hn::Zero(Lanes())), level), low)),
        middle(hn::Min(hn::Add(low, hn::Set(Lanes(), 1)), hn::Min(high, last))) {
    high = hn::Min(high, last);
  }
  IntVec low, high, middle;
};

// Returns the finest level on which a rectangle of `size` pixels meets at most three texels along each axis: the number
// of bits of (size - 2) / 2, read from the exponent of its float.
HWY_INLINE IntVec first_level_lanes(IntVec size, std::int32_t top) {
  const Lanes d;
  const IntVec half = hn::ShiftRight<1>(hn::Sub(hn::Max(size, hn::Set(d, 2)), hn::Set(d, 2)));
  const IntVec exponent = hn::ShiftRight<23>(hn::BitCast(d, hn::ConvertTo(FloatLanes(), half)));
  return hn::Min(hn::Max(hn::Sub(exponent, hn::Set(d, 126)), hn::Zero(d)), hn::Set(d, top));
}

HWY_INLINE FloatVec farthest_in_row(const float* texels, IntVec row, const TexelLanes& x) {
  const FloatLanes d;
  return hn::Min(
      hn::Min(hn::GatherIndex(d, texels, hn::Add(row, x.low)), hn::GatherIndex(d, texels, hn::Add(row, x.middle))),
      hn::GatherIndex(d, texels, hn::Add(row, x.high)));
}

HWY_INLINE IntVec quick_verdict_lanes(const DepthPyramid::Levels& levels, const BoundsOutput& bounds, std::size_t i) {
  const Lanes d;
  const IntVec x0 = hn::LoadU(d, bounds.x0.data() + i), x1 = hn::LoadU(d, bounds.x1.data() + i);
  const IntVec y0 = hn::LoadU(d, bounds.y0.data() + i), y1 = hn::LoadU(d, bounds.y1.data() + i);
  const FloatVec nearest = hn::LoadU(FloatLanes(), bounds.largest_nearness.data() + i);
  const IntVec level = first_level_lanes(hn::Max(hn::Sub(x1, x0), hn::Sub(y1, y0)), levels.top);
  const TexelLanes x(x0, x1, level, hn::GatherIndex(d, levels.last_x.data(), level));
  const TexelLanes y(y0, y1, level, hn::GatherIndex(d, levels.last_y.data(), level));
  const IntVec first = hn::GatherIndex(d, levels.first.data(), level);
  const IntVec stride = hn::GatherIndex(d, levels.stride.data(), level);
  FloatVec farthest = farthest_in_row(levels.texels, hn::Add(first, hn::Mul(y.low, stride)), x);
  farthest = hn::Min(farthest, farthest_in_row(levels.texels, hn::Add(first, hn::Mul(y.middle, stride)), x));
  farthest = hn::Min(farthest, farthest_in_row(levels.texels, hn::Add(first, hn::Mul(y.high, stride)), x));

  const IntVec column = hn::Min(hn::ShiftRight<1>(hn::Add(x0, x1)), hn::Set(d, levels.last_x[0]));
  const IntVec row = hn::Min(hn::ShiftRight<1>(hn::Add(y0, y1)), hn::Set(d, levels.last_y[0]));
  const IntVec pixel =
      hn::Add(hn::Add(hn::Mul(row, hn::Set(d, levels.stride[0])), hn::Set(d, levels.first[0])), column);
  const FloatVec middle = hn::GatherIndex(FloatLanes(), levels.texels, pixel);

  const auto visible = hn::RebindMask(d, hn::Le(middle, nearest));
  const auto holds_pixels = hn::And(hn::Lt(x0, x1), hn::Lt(y0, y1));
  const auto open = hn::And(holds_pixels, hn::RebindMask(d, hn::Le(farthest, nearest)));
  const IntVec otherwise =
      hn::IfThenElse(visible, hn::Set(d, static_cast<std::int32_t>(DepthPyramid::Verdict::visible)),
                     hn::Set(d, static_cast<std::int32_t>(DepthPyramid::Verdict::unknown)));
  return hn::IfThenElseZero(open, otherwise);
}

void quick_verdicts(const DepthPyramid::Levels& levels, const BoundsOutput& bounds, std::size_t count,
                    PerBound<std::int32_t>& verdicts) {
  for (std::size_t i = 0; i < count; i += hn::Lanes(Lanes()))
    hn::StoreU(quick_verdict_lanes(levels, bounds, i), Lanes(), verdicts.data() + i);
}

}  // namespace
}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {

HWY_EXPORT(reduce_level);
HWY_EXPORT(count_row);
HWY_EXPORT(quick_verdicts);

void reduce_depth(const DepthLevelView& below, const DepthLevelView& level, const PixelRect& changed) {
  HWY_DYNAMIC_DISPATCH(reduce_level)({below.texels, below.width, below.height, below.stride}, level, changed);
}

void halve_depth(const DepthTexels<const float>& below, const DepthLevelView& level, int columns) {
  HWY_DYNAMIC_DISPATCH(reduce_level)(below, level, {0, 0, columns, level.height});
}

std::uint32_t count_not_nearer(const float* texels, int count, float limit) {
  return HWY_DYNAMIC_DISPATCH(count_row)(texels, count, limit);
}

void find_quick_verdicts(const DepthPyramid::Levels& levels, const BoundsOutput& bounds, std::size_t count,
                         PerBound<std::int32_t>& verdicts) {
  HWY_DYNAMIC_DISPATCH(quick_verdicts)(levels, bounds, count, verdicts);
}

}  // namespace occlod
#endif  // HWY_ONCE
