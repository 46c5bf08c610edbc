// Projects batches of triangles from object space to snapped pixel coordinates, and sets up and scans triangles
// exactly.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <utility>

#include "occlod/mesh.h"
#include "raster/depth_image.h"

namespace occlod::raster {

inline constexpr int subpixel_bits = 8;
inline constexpr int subpixels = 1 << subpixel_bits;  // per pixel
// Corners at most this far from the middle of the image are drawn without clipping: they are at most 2^24 subpixels
// apart, so that products of two differences are exact in int64 and in double. Images have at most 2^14 pixels a side
// and are always inside the guard band.
inline constexpr double guard_band_px = 32768.0;

// A corner on the screen, in subpixels from the top left; computations with x and y are exact.
struct ScreenVertex {
  std::int32_t x = 0;
  std::int32_t y = 0;
  double nearness = 0.0;  // see DepthBuffer
};

// This bias is added before truncation, so that coordinates within the guard band are rounded as positive numbers.
inline constexpr double rounding_bias = 1 << 25;

// A multiple of the lane count of every instruction set.
inline constexpr std::size_t batch_triangles = 64;

// The corners of a batch: corner k of triangle i is at [k][i].
template <class T>
using Corners = std::array<std::array<T, batch_triangles>, 3>;

// A batch of triangles. Loops over it may write up to the end of its arrays, whatever its size.
struct TriangleBatch {
  std::size_t size = 0;
  Corners<float> object_x, object_y, object_z;
  Corners<double> clip_x, clip_y, clip_z, clip_w;
  Corners<std::int32_t> x, y;  // subpixels; 0 where not drawable
  Corners<double> nearness;
  Corners<std::int32_t> drawable;  // 1 when finite, not nearer than the near plane and inside the guard band

  [[nodiscard]] glm::dvec4 clip_position(std::size_t corner, std::size_t i) const noexcept {
    return {clip_x[corner][i], clip_y[corner][i], clip_z[corner][i], clip_w[corner][i]};
  }
  [[nodiscard]] ScreenVertex screen_vertex(std::size_t corner, std::size_t i) const noexcept {
    return {x[corner][i], y[corner][i], nearness[corner][i]};
  }
};

class Projection {
 public:
  Projection(const glm::mat4& object_to_clip, int width, int height);

  // Fills the batch with one to batch_triangles triangles. The result has the same bits with every instruction set.
  void project(std::span<const glm::vec3> positions, std::span<const Triangle> triangles, TriangleBatch& batch) const;
  // Snaps one corner, which is not nearer than the near plane and is inside the guard band, with the same arithmetic as
  // project().
  [[nodiscard]] ScreenVertex snap(const glm::dvec4& clip) const noexcept;
  [[nodiscard]] const glm::dmat4& to_clip() const noexcept { return to_clip_; }
  [[nodiscard]] const glm::dvec2& half_size() const noexcept { return half_size_; }  // subpixels
  // True when the matrix is affine; see DepthBuffer.
  [[nodiscard]] bool is_orthographic() const noexcept { return orthographic_; }
  // A corner is inside the guard band when |x| <= guard().x * w and |y| <= guard().y * w.
  [[nodiscard]] const glm::dvec2& guard() const noexcept { return guard_; }

 private:
  glm::dmat4 to_clip_;
  glm::dvec2 half_size_;  // subpixels
  glm::dvec2 guard_;
  bool orthographic_;
};

inline constexpr std::int32_t half_pixel = subpixels / 2;

// Returns the first pixel along one axis whose centre is not before `subpixel`: ceil((subpixel - 128) / 256).
[[nodiscard]] inline std::int32_t first_pixel(std::int32_t subpixel) noexcept {
  return (subpixel + half_pixel - 1) >> subpixel_bits;
}

// A non-horizontal edge that gives, row by row, the first pixel whose centre is on it or right of it. The same number
// starts the span of the triangle on its right and ends that of the triangle on its left, which is the top-left rule
// and leaves neither gap nor overlap.
//
// On the row with centre Y the edge from p to q is at X = p.x + (Y - p.y) dx / dy, and the pixel is ceil((X - 128) /
// 256) = ceil(n / d) with integers n = (Y - p.y) dx + (p.x - 128) dy and d = 256 dy. (n - 1/2) / d has the same ceiling
// and is at least 1 / (2 d) >= 2^-33 away from every integer; near the image it is below 2^15, where two roundings in
// double are below 2^-36: evaluating it in double is exact.
class EdgeWalk {
 public:
  // Precondition: p.y < q.y. `row` is the first row for which next() is called.
  EdgeWalk(const ScreenVertex& p, const ScreenVertex& q, std::int32_t row) noexcept {
    const std::int64_t dx = q.x - p.x;
    const std::int64_t dy = q.y - p.y;
    const std::int64_t y = std::int64_t{row} * subpixels + half_pixel - p.y;
    numerator_ = static_cast<double>(y * dx + (p.x - half_pixel) * dy) - 0.5;
    step_ = static_cast<double>(dx * subpixels);
    inverse_ = 1.0 / static_cast<double>(dy * subpixels);
  }
  // Returns the pixel of the current row, clamped to [0, limit], and advances to the next row.
  [[nodiscard]] std::int32_t next(double limit) noexcept {
    // This form compiles to SIMD minimum and maximum; std::min and std::max become branches here.
    double crossing = numerator_ * inverse_;
    numerator_ += step_;
    crossing = crossing > -1.0 ? crossing : -1.0;
    crossing += 1.0;
    return static_cast<std::int32_t>(crossing < limit ? crossing : limit);
  }

 private:
  double numerator_, step_, inverse_;
};

// Nearness as a linear function of the pixel centre, and the range to which it is clamped against rounding.
struct DepthPlane {
  double at_origin;  // nearness at the centre of pixel (0, 0)
  double per_column, per_row;
  float smallest, largest;

  [[nodiscard]] float at(std::int32_t column, std::int32_t row) const noexcept {
    return static_cast<float>((at_origin + per_row * row) + per_column * column);
  }
};

// Nearness is interpolated in single precision over at most this many pixels: its error is then less than the slope
// times 2^-16 of a pixel, which is little compared with the 2^-9 by which corners are moved to whole subpixels.
inline constexpr std::int32_t depth_reach = 64;

// Nearness along one row: clamp((start + step * (column - origin)) + row_term). A pixel's depth depends on the
// triangle and the pixel alone, not on the span or the block of pixels that it is drawn in.
struct DepthRow {
  float start, step, row_term;
  std::int32_t origin;
};

// A triangle that is ready to be scanned, with its corners from top to bottom.
struct TriangleSetup {
  ScreenVertex top, middle, bottom;
  std::int32_t first_row, middle_row, end_row;  // [first, middle) and [middle, end), inside the image
  bool middle_is_right;                         // right of the long edge from top to bottom
  std::int32_t first_column, end_column;        // of the bounding box, inside the image
  bool small;                                   // at most depth_reach pixels in both directions
  DepthPlane depth;

  // Returns the nearness for columns from `column` on. In small triangles it starts at the corner of the triangle's
  // bounding box; in large ones it starts at the last multiple of depth_reach and is valid up to the next one.
  [[nodiscard]] DepthRow depth_row(std::int32_t column, std::int32_t row) const noexcept {
    const auto step = static_cast<float>(depth.per_column);
    if (small)
      return {depth.at(first_column, first_row), step,
              static_cast<float>(depth.per_row) * static_cast<float>(row - first_row), first_column};
    const std::int32_t origin = column & -depth_reach;
    return {depth.at(origin, row), step, 0.0F, origin};
  }
};

// Returns twice the signed area in square subpixels; exact.
[[nodiscard]] inline std::int64_t twice_area(const ScreenVertex& a, const ScreenVertex& b,
                                             const ScreenVertex& c) noexcept {
  return std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{c.x - a.x} * (b.y - a.y);
}

inline DepthPlane depth_plane(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c,
                              std::int64_t area) noexcept {
  const double scale = subpixels / static_cast<double>(area);
  const double db = b.nearness - a.nearness;
  const double dc = c.nearness - a.nearness;
  DepthPlane plane{};
  plane.per_column = (db * (c.y - a.y) - dc * (b.y - a.y)) * scale;
  plane.per_row = (dc * (b.x - a.x) - db * (c.x - a.x)) * scale;
  const double pixel = 1.0 / subpixels;
  plane.at_origin = a.nearness + plane.per_column * (0.5 - a.x * pixel) + plane.per_row * (0.5 - a.y * pixel);
  plane.smallest = static_cast<float>(std::min({a.nearness, b.nearness, c.nearness}));
  plane.largest = static_cast<float>(std::max({a.nearness, b.nearness, c.nearness}));
  return plane;
}

// Returns false when the triangle has no area or its bounding box contains no pixel centre of the image.
[[nodiscard]] inline bool set_up(ScreenVertex a, ScreenVertex b, ScreenVertex c, int width, int height,
                                 TriangleSetup& setup) noexcept {
  const std::int32_t first_column = std::max(first_pixel(std::min({a.x, b.x, c.x})), 0);
  const std::int32_t end_column = std::min(first_pixel(std::max({a.x, b.x, c.x})), width);
  if (first_column >= end_column) return false;
  setup.first_column = first_column;
  setup.end_column = end_column;
  setup.depth = depth_plane(a, b, c, twice_area(a, b, c));
  if (a.y > b.y) std::swap(a, b);
  if (b.y > c.y) std::swap(b, c);
  if (a.y > b.y) std::swap(a, b);
  const std::int32_t width_subpixels = std::max({a.x, b.x, c.x}) - std::min({a.x, b.x, c.x});
  setup.small = std::max(width_subpixels, c.y - a.y) <= depth_reach * subpixels;
  setup.first_row = std::max(first_pixel(a.y), 0);
  setup.end_row = std::min(first_pixel(c.y), height);
  if (setup.first_row >= setup.end_row) return false;
  const std::int64_t area = twice_area(a, b, c);
  if (area == 0) return false;
  setup.middle_row = std::clamp(first_pixel(b.y), setup.first_row, setup.end_row);
  setup.middle_is_right = area > 0;
  setup.top = a;
  setup.middle = b;
  setup.bottom = c;
  return true;
}

// Calls span(row, first column, end column) for rows [row, end_row) between two edges.
template <class Span>
void scan_rows(EdgeWalk left, EdgeWalk right, std::int32_t row, std::int32_t end_row, int width, Span&& span) {
  const double limit = width;
  for (; row < end_row; ++row) {
    const std::int32_t begin = left.next(limit);
    const std::int32_t end = right.next(limit);
    if (begin < end) span(row, begin, end);
  }
}

// Calls span(row, first column, end column) for every row of `rows` that has pixels.
template <class Span>
void scan(const TriangleSetup& t, int width, const RowRange& rows, Span&& span) {
  const auto half = [&](const ScreenVertex& p, const ScreenVertex& q, std::int32_t first_row, std::int32_t end_row) {
    const std::int32_t row = std::max(first_row, rows.first);
    end_row = std::min(end_row, rows.end);
    if (row >= end_row) return;
    const EdgeWalk long_edge(t.top, t.bottom, row);
    const EdgeWalk short_edge(p, q, row);
    if (t.middle_is_right) {
      scan_rows(long_edge, short_edge, row, end_row, width, span);
    } else {
      scan_rows(short_edge, long_edge, row, end_row, width, span);
    }
  };
  half(t.top, t.middle, t.first_row, t.middle_row);
  half(t.middle, t.bottom, t.middle_row, t.end_row);
}

// Draws those triangles of the batch whose corners are all drawable and leaves the others to the caller, with the
// widest vectors of the machine. The result has the same bits with every instruction set, and as scan() and DepthRow
// give. Returns false, and draws nothing, when the image is narrower than a block of pixels or the machine has no
// vectors. `drawn` grows around every pixel drawn.
bool draw_depth_batch(const TriangleBatch& batch, const DepthImage& target, PixelRect& drawn);
// Draws as draw_depth_batch() does and adds the fragments to drawn.fragments.
bool draw_depth_batch_counted(const TriangleBatch& batch, const DepthImage& target, DrawnPixels& drawn);

}  // namespace occlod::raster
