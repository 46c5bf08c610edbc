#include "raster/depth_pyramid.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <limits>

#include "raster/depth_kernels.h"

namespace occlod {
namespace {

// Rows this many texels apart map to the same cache sets.
constexpr std::ptrdiff_t bad_stride = 256;

constexpr float infinity = std::numeric_limits<float>::infinity();

int halved(int size) { return (size + 1) / 2; }

PixelRect intersection(const PixelRect& a, const PixelRect& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

PixelRect middle_pixel(const PixelRect& rect) {
  const int x = (rect.x0 + rect.x1) / 2, y = (rect.y0 + rect.y1) / 2;
  return {x, y, x + 1, y + 1};
}

// Returns the finest level on which the rectangle meets at most three texels in each direction.
int first_level(const PixelRect& rect) {
  // On that level the rectangle has at most 2 * 2^level + 1 pixels a side.
  const int size = std::max(std::max(rect.x1 - rect.x0, rect.y1 - rect.y0), 2);
  return static_cast<int>(std::bit_width(static_cast<unsigned>(size - 2) / 2));
}

}  // namespace

DepthImage DepthPyramid::begin(int width, int height, bool clears) {
  lay_out(width, height);
  cleared_ = clears;
  const Level& level = levels_[0];
  float* image = texels_.data() + level.first;
  for (int y = drawn_.y0; clears && y < drawn_.y1; ++y)
    std::fill(image + y * level.stride + drawn_.x0, image + y * level.stride + drawn_.x1, 0.0F);
  return {image, width, height, level.stride};
}

void DepthPyramid::finish(const PixelRect& drawn) {
  PixelRect changed = cleared_ ? united(drawn_, drawn) : drawn;
  drawn_ = cleared_ ? drawn : united(drawn_, drawn);
  if (changed.empty()) return;
  const auto view = [this](const Level& level) {
    return DepthLevelView{texels_.data() + level.first, level.width, level.height, level.stride};
  };
  for (std::size_t i = 1; i < levels_.size(); ++i) {
    changed = {changed.x0 / 2, changed.y0 / 2, halved(changed.x1), halved(changed.y1)};
    reduce_depth(view(levels_[i - 1]), view(levels_[i]), changed);
  }
}

void DepthPyramid::build(const DepthBuffer& depth) {
  const DepthImage image = begin(depth.width, depth.height, false);
  for (int y = 0; y < depth.height; ++y)
    std::copy_n(depth.nearness.begin() + static_cast<std::ptrdiff_t>(y) * depth.width, depth.width,
                image.nearness + y * image.stride);
  finish({0, 0, depth.width, depth.height});
}

void DepthPyramid::build_halved(const DepthBuffer& depth) {
  assert(depth.width % 2 == 0 && depth.height % 2 == 0);
  const DepthImage image = begin(depth.width / 2, depth.height / 2, false);
  // Vectors would read beyond the last columns.
  const int in_vectors = image.width / depth_row_texels * depth_row_texels;
  halve_depth({depth.nearness.data(), depth.width, depth.height, depth.width},
              {image.nearness, image.width, image.height, image.stride}, in_vectors);
  for (int y = 0; y < image.height; ++y) {
    const float* upper = depth.nearness.data() + static_cast<std::ptrdiff_t>(2 * y) * depth.width;
    const float* lower = upper + depth.width;
    for (int x = in_vectors; x < image.width; ++x)
      image.nearness[y * image.stride + x] =
          std::min(std::min(upper[2 * x], upper[2 * x + 1]), std::min(lower[2 * x], lower[2 * x + 1]));
  }
  finish({0, 0, image.width, image.height});
}

void DepthPyramid::lay_out(int width, int height) {
  assert(width >= 1 && height >= 1);
  if (!levels_.empty() && levels_[0].width == width && levels_[0].height == height) return;
  drawn_ = {};
  levels_.clear();
  std::size_t size = 0;
  for (;; width = halved(width), height = halved(height)) {
    std::ptrdiff_t stride = (width + depth_row_texels - 1) / depth_row_texels * depth_row_texels;
    if (stride % bad_stride == 0) stride += depth_row_texels;
    levels_.push_back({width, height, stride, size});
    size += static_cast<std::size_t>(stride) * static_cast<std::size_t>(height);
    if (width == 1 && height == 1) break;
  }
  texels_.assign(size, infinity);
  for (const Level& level : levels_)
    for (int y = 0; y < level.height; ++y)
      std::fill_n(texels_.data() + level.first + static_cast<std::size_t>(y * level.stride), level.width, 0.0F);
}

float DepthPyramid::farthest(int level, int x, int y) const noexcept {
  return row(levels_[static_cast<std::size_t>(level)], y)[x];
}

DepthPyramid::Levels DepthPyramid::levels() const noexcept {
  Levels table;
  table.texels = texels_.data();
  table.top = level_count() - 1;
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    table.first[i] = static_cast<std::int32_t>(levels_[i].first);
    table.stride[i] = static_cast<std::int32_t>(levels_[i].stride);
    table.last_x[i] = levels_[i].width - 1;
    table.last_y[i] = levels_[i].height - 1;
  }
  return table;
}

DepthPyramid::Verdict DepthPyramid::quick_verdict(const PixelRect& rect, float largest_nearness) const noexcept {
  const int index = first_level(rect);
  const Level& level = levels_[static_cast<std::size_t>(index)];
  // The texels are inside the image even when the rectangle is empty.
  const int x0 = std::min(rect.x0 >> index, level.width - 1), x2 = std::max((rect.x1 - 1) >> index, x0);
  const int y0 = std::min(rect.y0 >> index, level.height - 1), y2 = std::max((rect.y1 - 1) >> index, y0);
  const int x1 = std::min(x0 + 1, x2), y1 = std::min(y0 + 1, y2);
  const auto farthest_in_row = [=, this](int y) {
    const float* texels = row(level, y);
    return std::min(std::min(texels[x0], texels[x1]), texels[x2]);
  };
  const float farthest = std::min(std::min(farthest_in_row(y0), farthest_in_row(y1)), farthest_in_row(y2));
  const Level& image = levels_[0];
  const float middle = row(
      image, std::min((rect.y0 + rect.y1) / 2, image.height - 1))[std::min((rect.x0 + rect.x1) / 2, image.width - 1)];
  const bool hidden = rect.empty() | (farthest > largest_nearness);
  const Verdict otherwise = middle <= largest_nearness ? Verdict::visible : Verdict::unknown;
  return hidden ? Verdict::hidden : otherwise;
}

bool DepthPyramid::any_visible(const PixelRect& rect, float largest_nearness, const Diagonals& diagonals) const {
  assert(rect.empty() || (rect.x0 >= 0 && rect.y0 >= 0 && rect.x1 <= width() && rect.y1 <= height()));
  const Verdict verdict = quick_verdict(rect, largest_nearness);
  if (verdict == Verdict::hidden) return false;
  if (verdict == Verdict::visible && diagonals.meet(middle_pixel(rect))) return true;
  return search_visible(rect, largest_nearness, diagonals);
}

bool DepthPyramid::search_visible(const PixelRect& rect, float largest_nearness, const Diagonals& diagonals) const {
  // Where the middle is hidden, the border is often visible: half of the bound is behind an edge of the occluder.
  const int middle_x = (rect.x0 + rect.x1) / 2, middle_y = (rect.y0 + rect.y1) / 2;
  for (const int y : {rect.y0, middle_y, rect.y1 - 1})
    for (const int x : {rect.x0, middle_x, rect.x1 - 1})
      if (row(levels_[0], y)[x] <= largest_nearness && diagonals.meet({x, y, x + 1, y + 1})) return true;
  return any_visible_at(first_level(rect), rect, diagonals, largest_nearness);
}

bool DepthPyramid::any_visible_at(int level, const PixelRect& rect, const Diagonals& diagonals, float nearest) const {
  for (int y = rect.y0 >> level; y <= (rect.y1 - 1) >> level; ++y) {
    const float* texels = row(levels_[static_cast<std::size_t>(level)], y);
    for (int x = rect.x0 >> level; x <= (rect.x1 - 1) >> level; ++x) {
      if (texels[x] > nearest) continue;
      const PixelRect texel = {x << level, y << level, std::min((x + 1) << level, width()),
                               std::min((y + 1) << level, height())};
      const PixelRect part = intersection(rect, texel);
      if (!diagonals.meet(part)) continue;
      const bool whole = part.x0 == texel.x0 && part.y0 == texel.y0 && part.x1 == texel.x1 && part.y1 == texel.y1;
      // Some pixel of the texel, its farthest, is visible; when the query contains the whole texel, that decides.
      if (level == 0 || (whole && diagonals.hold(texel)) || any_visible_at(level - 1, part, diagonals, nearest))
        return true;
    }
  }
  return false;
}

std::uint32_t DepthPyramid::count_visible(const PixelRect& rect, float largest_nearness,
                                          const Diagonals& diagonals) const {
  if (quick_verdict(rect, largest_nearness) == Verdict::hidden) return 0;
  std::uint32_t count = 0;
  for (int y = rect.y0; y < rect.y1; ++y) {
    // The pixels of a row that meet the diagonals are consecutive.
    int x0 = rect.x0, x1 = rect.x1;
    while (x0 < x1 && !diagonals.meet({x0, y, x0 + 1, y + 1})) ++x0;
    while (x0 < x1 && !diagonals.meet({x1 - 1, y, x1, y + 1})) --x1;
    count += count_not_nearer(row(levels_[0], y) + x0, x1 - x0, largest_nearness);
  }
  return count;
}

}  // namespace occlod
