#include "raster/depth_epochs.h"

#include <algorithm>
#include <cmath>

namespace occlod {
namespace {

// Numbers up to 2^60 and down to 2^-60 stay in the range of floats when they are multiplied or divided by as much.
constexpr int most_exponent = 60;

bool is_in_range(double number) { return number == 0.0 || (std::abs(number) <= 0x1p60 && std::abs(number) >= 0x1p-60); }

bool is_in_range(const ObjectView& object) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!is_in_range(static_cast<double>(object.object_to_clip()[column][row]))) return false;
  return true;
}

}  // namespace

bool DepthEpochs::begin(const View& view, std::span<const ObjectView> objects) {
  const Range range = {view.camera().near, view.camera().far, view.width(), view.height()};
  const bool can_scale =
      !view.is_orthographic() && range.near >= 0x1p-40 && range.far <= 0x1p40 &&
      std::all_of(objects.begin(), objects.end(), [](const ObjectView& object) { return is_in_range(object); });
  if (!can_scale) {
    range_.reset();
    scale_ = 1.0F;
    least_ = 0.0F;
    return false;
  }
  // From the nearest of one picture to beyond the farthest of the next.
  const int step = static_cast<int>(std::ceil(std::log2(range.far / range.near))) + 3;
  const bool goes_on = range_ == range && exponent_ + step <= most_exponent;
  exponent_ = goes_on ? exponent_ + step : -most_exponent;
  range_ = range;
  scale_ = std::ldexp(1.0F, exponent_);
  least_ = scale_ * static_cast<float>(0.25 / range.far);
  return goes_on;
}

}  // namespace occlod
