// A hierarchical z-buffer (Greene, Kass, Miller 1993): each level holds the farthest depth of 2x2 texels of the level
// below.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "occlod/item_buffer.h"
#include "raster/depth_image.h"

namespace occlod {

// Ranges of x + y and of x - y in pixels, y down, which cut off the corners of a rectangle.
struct Diagonals {
  double sum_low = -std::numeric_limits<double>::infinity();
  double sum_high = std::numeric_limits<double>::infinity();
  double difference_low = -std::numeric_limits<double>::infinity();
  double difference_high = std::numeric_limits<double>::infinity();

  // False when the ranges leave no point of `rect`.
  [[nodiscard]] bool meet(const PixelRect& rect) const noexcept {
    return rect.x1 + rect.y1 >= sum_low && rect.x0 + rect.y0 <= sum_high && rect.x1 - rect.y0 >= difference_low &&
           rect.x0 - rect.y1 <= difference_high;
  }
  // True when the ranges leave all of `rect`.
  [[nodiscard]] bool hold(const PixelRect& rect) const noexcept {
    return rect.x0 + rect.y0 >= sum_low && rect.x1 + rect.y1 <= sum_high && rect.x0 - rect.y1 >= difference_low &&
           rect.x1 - rect.y0 <= difference_high;
  }
};

class DepthPyramid {
 public:
  // Lays out levels for an image of at least one pixel and returns level 0 for the caller to draw into. Odd sizes round
  // up. The image is valid until the next begin(). Reuses its memory. With `clears` level 0 is emptied; without, it
  // keeps the previous picture, for pictures in which everything is nearer than that.
  [[nodiscard]] DepthImage begin(int width, int height, bool clears = true);
  // Reduces level 0 where it has changed, until one texel is left. `drawn` contains every pixel that is not empty. Must
  // be called before the functions below. O(pixels drawn now or before).
  void finish(const PixelRect& drawn);
  // Calls begin() and finish() with a copy of `depth` as level 0.
  void build(const DepthBuffer& depth);
  // Does the same with the farthest depth of each 2x2 pixels, of images with even sides; in half of the time.
  void build_halved(const DepthBuffer& depth);

  [[nodiscard]] int level_count() const noexcept { return static_cast<int>(levels_.size()); }
  [[nodiscard]] int width() const noexcept { return levels_.empty() ? 0 : levels_[0].width; }
  [[nodiscard]] int height() const noexcept { return levels_.empty() ? 0 : levels_[0].height; }
  // Returns the smallest nearness of the texel, that of the farthest occluder.
  [[nodiscard]] float farthest(int level, int x, int y) const noexcept;

  // True iff at some pixel of `rect` (inside the image) the occluder is not nearer than largest_nearness, that is
  // farthest <= nearest. Exact: descends only where a coarser texel cannot decide. False for an empty rectangle. With
  // diagonals, only pixels that they meet count.
  [[nodiscard]] bool any_visible(const PixelRect& rect, float largest_nearness, const Diagonals& diagonals = {}) const;
  // The answer of any_visible() from a few texels and the pixel in the middle, without branches; `unknown` where these
  // do not decide, which is rare.
  enum class Verdict : std::uint8_t { hidden, visible, unknown };
  [[nodiscard]] Verdict quick_verdict(const PixelRect& rect, float largest_nearness) const noexcept;

  // Answers any_visible() where quick_verdict() is unknown.
  [[nodiscard]] bool search_visible(const PixelRect& rect, float largest_nearness, const Diagonals& diagonals) const;

  // The levels as vector loops gather from them. Images have at most 2^14 pixels a side, so there are at most 15
  // levels.
  struct Levels {
    static constexpr std::size_t capacity = 16;
    const float* texels = nullptr;
    std::int32_t top = 0;                                                      // index of the last level
    std::array<std::int32_t, capacity> first{}, stride{}, last_x{}, last_y{};  // texel (x, y) at first + y * stride + x
  };
  [[nodiscard]] Levels levels() const noexcept;
  // Counts the pixels of `rect` at which the occluder is not nearer than largest_nearness. With diagonals, only pixels
  // that they meet count. O(pixels of the rectangle).
  [[nodiscard]] std::uint32_t count_visible(const PixelRect& rect, float largest_nearness,
                                            const Diagonals& diagonals = {}) const;

 private:
  struct Level {
    int width = 0;
    int height = 0;
    std::ptrdiff_t stride = 0;  // texels beyond the width are infinite
    std::size_t first = 0;      // index in texels_
  };
  void lay_out(int width, int height);
  [[nodiscard]] const float* row(const Level& level, int y) const noexcept {
    return texels_.data() + level.first + static_cast<std::size_t>(y * level.stride);
  }
  [[nodiscard]] bool any_visible_at(int level, const PixelRect& rect, const Diagonals& diagonals, float nearest) const;

  // All levels are empty outside this rectangle.
  PixelRect drawn_;
  bool cleared_ = true;  // true when the last begin() cleared level 0
  std::vector<Level> levels_;
  std::vector<float> texels_;
};

}  // namespace occlod
