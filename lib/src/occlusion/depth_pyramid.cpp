#include "occlod/occlusion/depth_pyramid.h"

#include <algorithm>
#include <cassert>

namespace occlod {
namespace {

// Rectangles of at most this many pixels in each direction are read directly.
constexpr int direct_size = 8;
// The descent starts on the level where the rectangle meets at most this many texels, or one more, in each direction.
constexpr int first_texels = 2;

// One row of a level from two of the level below; `below_width` may be odd, and then the last texel has one column
// only.
void reduce_row(const float* upper, const float* lower, int below_width, float* out) {
  const auto pairs = static_cast<std::size_t>(below_width / 2);
  for (std::size_t x = 0; x < pairs; ++x)
    out[x] = std::min(std::min(upper[2 * x], upper[2 * x + 1]), std::min(lower[2 * x], lower[2 * x + 1]));
  if (below_width % 2 != 0) out[pairs] = std::min(upper[below_width - 1], lower[below_width - 1]);
}

int halved(int size) { return (size + 1) / 2; }

PixelRect intersection(const PixelRect& a, const PixelRect& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

bool empty(const PixelRect& rect) { return rect.x0 >= rect.x1 || rect.y0 >= rect.y1; }

}  // namespace

void DepthPyramid::build(const DepthBuffer& depth) {
  lay_out(depth.width, depth.height);
  std::copy(depth.inverse_depth.begin(), depth.inverse_depth.end(), texels_.begin());
  for (std::size_t i = 1; i < levels_.size(); ++i) {
    const Level& below = levels_[i - 1];
    for (int y = 0; y < levels_[i].height; ++y) {
      const int lower = std::min(2 * y + 1, below.height - 1);
      reduce_row(
          row(below, 2 * y), row(below, lower), below.width,
          texels_.data() + levels_[i].first + static_cast<std::size_t>(y) * static_cast<std::size_t>(levels_[i].width));
    }
  }
}

void DepthPyramid::lay_out(int width, int height) {
  assert(width >= 1 && height >= 1);
  levels_.clear();
  std::size_t size = 0;
  for (;; width = halved(width), height = halved(height)) {
    levels_.push_back({width, height, size});
    size += static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (width == 1 && height == 1) break;
  }
  texels_.resize(size);
}

const float* DepthPyramid::row(const Level& level, int y) const noexcept {
  return texels_.data() + level.first + static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width);
}

float DepthPyramid::farthest(int level, int x, int y) const noexcept {
  return row(levels_[static_cast<std::size_t>(level)], y)[x];
}

bool DepthPyramid::any_visible(const PixelRect& rect, float nearest_inverse_depth) const {
  if (empty(rect)) return false;
  assert(rect.x0 >= 0 && rect.y0 >= 0 && rect.x1 <= width() && rect.y1 <= height());
  const int size = std::max(rect.x1 - rect.x0, rect.y1 - rect.y0);
  int level = 0;
  if (size > direct_size)
    while ((size >> level) > first_texels) ++level;
  return any_visible_at(level, rect, nearest_inverse_depth);
}

bool DepthPyramid::any_visible_at(int level, const PixelRect& rect, float nearest) const {
  if (level == 0) return any_visible_pixel(rect, nearest);
  for (int y = rect.y0 >> level; y <= (rect.y1 - 1) >> level; ++y) {
    const float* texels = row(levels_[static_cast<std::size_t>(level)], y);
    for (int x = rect.x0 >> level; x <= (rect.x1 - 1) >> level; ++x) {
      if (texels[x] > nearest) continue;
      const PixelRect texel = {x << level, y << level, std::min((x + 1) << level, width()),
                               std::min((y + 1) << level, height())};
      const PixelRect part = intersection(rect, texel);
      const bool whole = part.x0 == texel.x0 && part.y0 == texel.y0 && part.x1 == texel.x1 && part.y1 == texel.y1;
      // The farthest pixel of the texel is visible; when the texel lies in the rectangle, so does that pixel.
      if (whole || any_visible_at(level - 1, part, nearest)) return true;
    }
  }
  return false;
}

bool DepthPyramid::any_visible_pixel(const PixelRect& rect, float nearest) const {
  for (int y = rect.y0; y < rect.y1; ++y) {
    const float* pixels = row(levels_[0], y);
    float farthest_in_row = pixels[rect.x0];
    for (int x = rect.x0; x < rect.x1; ++x) farthest_in_row = std::min(farthest_in_row, pixels[x]);
    if (farthest_in_row <= nearest) return true;
  }
  return false;
}

std::uint32_t DepthPyramid::count_visible(const PixelRect& rect, float nearest_inverse_depth) const {
  std::uint32_t count = 0;
  for (int y = rect.y0; y < rect.y1; ++y) {
    const float* pixels = row(levels_[0], y);
    for (int x = rect.x0; x < rect.x1; ++x) count += pixels[x] <= nearest_inverse_depth ? 1U : 0U;
  }
  return count;
}

}  // namespace occlod
