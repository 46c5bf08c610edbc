#include "occlusion/depth_kernels.h"

#include <algorithm>

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "occlusion/depth_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, depth_row_texels / 2>;
using Vec = hn::Vec<Floats>;

// The smallest of each pair of neighbours in `low` and then `high`.
HWY_INLINE Vec smallest_of_pairs(Vec low, Vec high) {
#if HWY_TARGET == HWY_SCALAR
  return hn::Min(low, high);
#else
  const Floats d;
  return hn::Min(hn::ConcatEven(d, high, low), hn::ConcatOdd(d, high, low));
#endif
}

void reduce_level(const DepthLevelView& below, const DepthLevelView& level) {
  const Floats d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int y = 0; y < level.height; ++y) {
    const float* upper = below.texels + 2 * y * below.stride;
    const float* lower = below.texels + std::min(2 * y + 1, below.height - 1) * below.stride;
    float* out = level.texels + y * level.stride;
    for (int x = 0; x < level.width; x += lanes) {
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

}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {

HWY_EXPORT(reduce_level);
HWY_EXPORT(count_row);

void reduce_depth(const DepthLevelView& below, const DepthLevelView& level) {
  HWY_DYNAMIC_DISPATCH(reduce_level)(below, level);
}

std::uint32_t count_not_nearer(const float* texels, int count, float limit) {
  return HWY_DYNAMIC_DISPATCH(count_row)(texels, count, limit);
}

}  // namespace occlod
#endif  // HWY_ONCE
