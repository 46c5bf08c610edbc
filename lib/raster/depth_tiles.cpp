#include "raster/depth_tiles.h"

#include <algorithm>

namespace occlod::raster {
namespace {

constexpr int tiles_over(int pixels) { return (pixels + DepthTiles::size - 1) / DepthTiles::size; }

// Of [begin, end) of a row.
std::uint32_t count_passed(const float* depth, const BoxFront::Row& front, std::int32_t begin, std::int32_t end) {
  std::uint32_t passed = 0;
  for (std::int32_t x = begin; x < end; ++x)
    passed += static_cast<double>(depth[x]) <= front.at(static_cast<double>(x)) ? 1U : 0U;
  return passed;
}

}  // namespace

void DepthTiles::begin(const DepthImage& image) {
  image_ = image;
  columns_ = tiles_over(image.width);
  tiles_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(tiles_over(image.height)), {});
}

void DepthTiles::change(const PixelRect& drawn) {
  if (drawn.empty()) return;
  for (int y = drawn.y0 / size; y < tiles_over(drawn.y1); ++y) {
    Tile* const row = tiles_.data() + static_cast<std::ptrdiff_t>(y) * columns_;
    for (int x = drawn.x0 / size; x < tiles_over(drawn.x1); ++x) row[x].known = false;
  }
}

const DepthTiles::Tile& DepthTiles::tile(int x, int y) {
  Tile& tile = tiles_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x)];
  if (tile.known) return tile;
  const int x0 = x * size, x1 = std::min(x0 + size, image_.width);
  const int y0 = y * size, y1 = std::min(y0 + size, image_.height);
  float farthest = image_.nearness[y0 * image_.stride + x0], nearest = farthest;
  for (int row = y0; row < y1; ++row) {
    const float* const depth = image_.nearness + row * image_.stride;
    for (int column = x0; column < x1; ++column) {
      farthest = farthest < depth[column] ? farthest : depth[column];
      nearest = nearest > depth[column] ? nearest : depth[column];
    }
  }
  tile = {farthest, nearest, true};
  return tile;
}

DepthCount DepthTiles::count(const ProjectedBox& box) {
  outline_.assign(box, image_.width, image_.height);
  if (outline_.pixels() == 0) return {};
  const BoxFront front(box);
  DepthCount count{0, outline_.pixels()};
  for (std::int32_t y = outline_.first_row(); y < outline_.end_row();) {
    const std::int32_t end = std::min((y / size + 1) * size, outline_.end_row());
    count.passed += count_in_band(front, y, end);
    y = end;
  }
  return count;
}

std::uint32_t DepthTiles::count_in_band(const BoxFront& front, std::int32_t first_row, std::int32_t end_row) {
  std::int32_t begin = image_.width, end = 0;
  for (std::int32_t y = first_row; y < end_row; ++y) {
    if (outline_.span(y).begin == outline_.span(y).end) continue;
    begin = std::min(begin, outline_.span(y).begin);
    end = std::max(end, outline_.span(y).end);
  }
  std::uint32_t passed = 0;
  for (std::int32_t x = begin; x < end;) {
    const std::int32_t end_of_tile = std::min((x / size + 1) * size, end);
    passed += count_in_tile(front, {x, first_row, end_of_tile, end_row});
    x = end_of_tile;
  }
  return passed;
}

std::uint32_t DepthTiles::count_in_tile(const BoxFront& front, const PixelRect& rect) {
  const Tile& known = tile(rect.x0 / size, rect.y0 / size);
  const BoxFront::Range range = front.range(rect.x0, rect.y0, rect.x1, rect.y1);
  if (static_cast<double>(known.farthest) > range.most) return 0;
  if (static_cast<double>(known.nearest) <= range.least) return covered_in(rect);
  std::uint32_t passed = 0;
  for (std::int32_t y = rect.y0; y < rect.y1; ++y) {
    const BoxOutline::Span& span = outline_.span(y);
    passed += count_passed(image_.nearness + y * image_.stride, front.row(y), std::max(span.begin, rect.x0),
                           std::min(span.end, rect.x1));
  }
  return passed;
}

std::uint32_t DepthTiles::covered_in(const PixelRect& rect) const {
  std::int32_t covered = 0;
  for (std::int32_t y = rect.y0; y < rect.y1; ++y) {
    const BoxOutline::Span& span = outline_.span(y);
    covered += std::max(std::min(span.end, rect.x1) - std::max(span.begin, rect.x0), 0);
  }
  return static_cast<std::uint32_t>(covered);
}

}  // namespace occlod::raster
