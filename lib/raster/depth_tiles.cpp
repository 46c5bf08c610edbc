#include "raster/depth_tiles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>

namespace occlod::raster {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The edges of a box are the pairs of corners whose numbers differ in one bit.
struct Edge {
  std::size_t from, to;
};
constexpr std::array<Edge, 12> edges{
    {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

// Corners of each face, counter-clockwise seen from outside.
constexpr std::array<std::array<std::size_t, 4>, 6> faces{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

// Least width in pixels of a front face that counts: narrower ones hardly show, and their planes would be mostly
// rounding error.
constexpr double thinnest_face = 1.0 / 128.0;

// Returns the first pixel whose centre is not before x, in [0, size].
std::int32_t first_pixel_at(double x, int size) {
  return static_cast<std::int32_t>(std::clamp(std::ceil(x - 0.5), 0.0, static_cast<double>(size)));
}

// Returns the cross product of x and y.
double cross_on_screen(const glm::dvec3& a, const glm::dvec3& b) { return a.x * b.y - a.y * b.x; }

}  // namespace

// A row's centre line crosses the outline where it crosses the leftmost and the rightmost of the twelve edges that it
// meets, so we need not know which edges form the outline.
void BoxOutline::assign(const ProjectedBox& box, int width, int height) {
  double top = infinity, bottom = -infinity;
  for (const glm::dvec3& corner : box.corners) {
    top = std::min(top, corner.y);
    bottom = std::max(bottom, corner.y);
  }
  first_row_ = first_pixel_at(top, height);
  const std::int32_t end = std::max(first_pixel_at(bottom, height), first_row_);
  crossings_.assign(static_cast<std::size_t>(end - first_row_), {infinity, -infinity});
  for (const Edge& edge : edges) {
    const bool down = box.corners[edge.from].y <= box.corners[edge.to].y;
    const glm::dvec3& p = box.corners[down ? edge.from : edge.to];
    const glm::dvec3& q = box.corners[down ? edge.to : edge.from];
    const double slope = (q.x - p.x) / (q.y - p.y);  // not used where the edge is horizontal
    const std::int32_t end_of_edge = first_pixel_at(q.y, height);
    for (std::int32_t row = first_pixel_at(p.y, height); row < end_of_edge; ++row) {
      const double x = p.x + (row + 0.5 - p.y) * slope;
      Crossing& crossing = crossings_[static_cast<std::size_t>(row - first_row_)];
      crossing.left = crossing.left < x ? crossing.left : x;
      crossing.right = crossing.right > x ? crossing.right : x;
    }
  }
  spans_.clear();
  pixels_ = 0;
  for (const Crossing& crossing : crossings_) {
    const Span span{first_pixel_at(crossing.left, width), first_pixel_at(crossing.right, width)};
    spans_.push_back(span);
    pixels_ += static_cast<std::uint32_t>(span.end - span.begin);
  }
}

BoxFront::BoxFront(const ProjectedBox& box) : least_(infinity), most_(0.0) {
  for (const glm::dvec3& corner : box.corners) {
    least_ = std::min(least_, corner.z);
    most_ = std::max(most_, corner.z);
  }
  least_ = std::max(least_, 0.0);  // what is beyond the far plane of an orthographic view has nearness 0 and still
                                   // passes on empty pixels
  planes_.fill({infinity, 0.0, 0.0});
  std::size_t count = 0;
  for (const auto& face : faces) {
    const glm::dvec3 first = box.corners[face[2]] - box.corners[face[0]];
    const glm::dvec3 second = box.corners[face[3]] - box.corners[face[1]];
    // area is twice the face's area; it is negative when the face is counter-clockwise on the screen, where y points
    // down.
    const double area = cross_on_screen(first, second) * (box.mirrored ? -1.0 : 1.0);
    const double longest = std::max(glm::length(glm::dvec2(first)), glm::length(glm::dvec2(second)));
    if (count == max_planes || !(-area > thinnest_face * longest)) continue;
    // The plane passes through one corner and is spanned by the diagonals.
    const double scale = 1.0 / cross_on_screen(first, second);
    Plane plane{};
    plane.per_column = (first.z * second.y - second.z * first.y) * scale;
    plane.per_row = (second.z * first.x - first.z * second.x) * scale;
    const glm::dvec3& corner = box.corners[face[0]];
    plane.at_origin = corner.z + plane.per_column * (0.5 - corner.x) + plane.per_row * (0.5 - corner.y);
    planes_[count++] = plane;
  }
}

BoxFront::Range BoxFront::range(std::int32_t x0, std::int32_t y0, std::int32_t x1, std::int32_t y1) const noexcept {
  // Each plane has its minimum and maximum at a corner, computed with the same arithmetic as single pixels.
  const Row upper = row(y0), lower = row(y1 - 1);
  const double left = x0, right = x1 - 1;
  Range range{most_, most_};
  for (std::size_t i = 0; i < max_planes; ++i) {
    const double a = upper.start[i] + upper.step[i] * left, b = upper.start[i] + upper.step[i] * right;
    const double c = lower.start[i] + lower.step[i] * left, d = lower.start[i] + lower.step[i] * right;
    range.least = std::min(range.least, std::min(std::min(a, b), std::min(c, d)));
    range.most = std::min(range.most, std::max(std::max(a, b), std::max(c, d)));
  }
  return {std::max(range.least, least_), std::max(range.most, least_)};
}

namespace {

constexpr int tiles_over(int pixels) { return (pixels + DepthTiles::size - 1) / DepthTiles::size; }

// Counts the pixels [begin, end) of a row that pass the depth test.
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
