#include "hlod/draw/node_images.h"

#include <algorithm>
#include <cassert>

namespace occlod::hlod {
namespace {

std::uint64_t key_of(const NodeDraw& draw) { return std::uint64_t{draw.object} << 32U | draw.node; }

}  // namespace

void NodeImages::begin(const ImageView& view) {
  if (view == view_) return;
  view_ = view;
  scratch_.assign(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height), 0.0F);
  images_.clear();
  ranges_.clear();
  rows_.clear();
  pixels_.clear();
}

const NodeImages::Image* NodeImages::find(const NodeDraw& draw) const {
  const auto [begin, end] = images_.equal_range(key_of(draw));
  const auto found = std::find_if(begin, end, [&](const auto& entry) {
    const std::span ranges = std::span(ranges_).subspan(entry.second.first_range, entry.second.range_count);
    return std::ranges::equal(ranges, draw.ranges);
  });
  return found != end ? &found->second : nullptr;
}

void NodeImages::blend(const Image& image, const DepthImage& target) const {
  assert(target.width == view_.width && target.height == view_.height);
  for (int y = image.drawn.rect.y0; y < image.drawn.rect.y1; ++y) {
    const Row& row = rows_[image.first_row + static_cast<std::size_t>(y - image.drawn.rect.y0)];
    const float* const from = pixels_.data() + row.first;
    float* const to = target.nearness + y * target.stride + row.x0;
    for (int i = 0; i < row.x1 - row.x0; ++i) to[i] = to[i] < from[i] ? from[i] : to[i];
  }
}

DepthImage NodeImages::empty_image() { return {scratch_.data(), view_.width, view_.height, view_.width}; }

const NodeImages::Image& NodeImages::keep(const NodeDraw& draw, std::uint64_t triangles, const DrawnPixels& drawn) {
  const Image image{drawn, triangles, ranges_.size(), draw.ranges.size(), rows_.size()};
  ranges_.insert(ranges_.end(), draw.ranges.begin(), draw.ranges.end());
  for (int y = drawn.rect.y0; y < drawn.rect.y1; ++y) keep_row(empty_image(), drawn.rect, y);
  return images_.emplace(key_of(draw), image)->second;
}

// Moves a row out of the image, which is empty afterwards.
void NodeImages::keep_row(const DepthImage& image, const PixelRect& rect, int y) {
  float* const row = image.nearness + y * image.stride;
  const auto is_covered = [](float nearness) { return nearness > 0.0F; };
  float* const begin = std::find_if(row + rect.x0, row + std::max(rect.x0, rect.x1), is_covered);
  float* end = row + std::max(rect.x0, rect.x1);
  while (end > begin && !is_covered(end[-1])) --end;
  rows_.push_back({static_cast<int>(begin - row), static_cast<int>(end - row), pixels_.size()});
  pixels_.insert(pixels_.end(), begin, end);
  std::fill(begin, end, 0.0F);
}

}  // namespace occlod::hlod
