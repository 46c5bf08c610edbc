// Hierarchical z-buffer (Greene, Kass, Miller 1993): each level holds the farthest depth of 2x2 texels of the level
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

// Cuts off the corners of a rectangle: x + y and x - y of the points that are left, in pixels; y down.
struct Diagonals {
  double sum_low = -std::numeric_limits<double>::infinity();
  double sum_high = std::numeric_limits<double>::infinity();
  double difference_low = -std::numeric_limits<double>::infinity();
  double difference_high = std::numeric_limits<double>::infinity();

  // False when no point of `rect` is left.
  [[nodiscard]] bool meet(const PixelRect& rect) const noexcept {
    return rect.x1 + rect.y1 >= sum_low && rect.x0 + rect.y0 <= sum_high && rect.x1 - rect.y0 >= difference_low &&
           rect.x0 - rect.y1 <= difference_high;
  }
  // True when all of it is left.
  [[nodiscard]] bool hold(const PixelRect& rect) const noexcept {
    return rect.x0 + rect.y0 >= sum_low && rect.x1 + rect.y1 <= sum_high && rect.x0 - rect.y1 >= difference_low &&
           rect.x1 - rect.y0 <= difference_high;
  }
};

class DepthPyramid {
 public:
  // Lays out levels for an image of at least one pixel and empties level 0, which the caller then draws into. Odd sizes
  // round up. The image is valid until the next begin(). Reuses its memory.
  // `clears`: what was drawn before is taken away; else it stays, for pictures in which everything is nearer than that.
  [[nodiscard]] DepthImage begin(int width, int height, bool clears = true);
  // Reduces level 0 until one texel is left, where it has changed. drawn: holds every pixel that is not empty.
  // Everything below needs it. O(pixels drawn now or before).
  void finish(const PixelRect& drawn);
  // Both, with a copy of `depth` as level 0.
  void build(const DepthBuffer& depth);

  [[nodiscard]] int level_count() const noexcept { return static_cast<int>(levels_.size()); }
  [[nodiscard]] int width() const noexcept { return levels_.empty() ? 0 : levels_[0].width; }
  [[nodiscard]] int height() const noexcept { return levels_.empty() ? 0 : levels_[0].height; }
  // Smallest nearness (farthest occluder) of the texel.
  [[nodiscard]] float farthest(int level, int x, int y) const noexcept;

  // True iff at some pixel of `rect` (inside the image) the occluder is not nearer than largest_nearness, that is
  // farthest <= nearest. Exact: descends only where a coarser texel cannot decide. An empty rectangle shows nothing.
  // With diagonals only of those that they meet.
  [[nodiscard]] bool any_visible(const PixelRect& rect, float largest_nearness, const Diagonals& diagonals = {}) const;
  // The same where a few texels and the pixel in the middle decide it, which is most often; without branches.
  enum class Verdict : std::uint8_t { hidden, visible, unknown };
  [[nodiscard]] Verdict quick_verdict(const PixelRect& rect, float largest_nearness) const noexcept;

  // any_visible() of what quick_verdict() does not tell.
  [[nodiscard]] bool search_visible(const PixelRect& rect, float largest_nearness, const Diagonals& diagonals) const;

  // The levels as vectors gather them. Images have at most 2^14 pixels a side, so at most 15 levels.
  struct Levels {
    static constexpr std::size_t capacity = 16;
    const float* texels = nullptr;
    std::int32_t top = 0;                                                      // the last level
    std::array<std::int32_t, capacity> first{}, stride{}, last_x{}, last_y{};  // texel (x, y) at first + y * stride + x
  };
  [[nodiscard]] Levels levels() const noexcept;
  // How many such pixels there are. O(pixels of the rectangle).
  [[nodiscard]] std::uint32_t count_visible(const PixelRect& rect, float largest_nearness,
                                            const Diagonals& diagonals = {}) const;

 private:
  struct Level {
    int width = 0;
    int height = 0;
    std::ptrdiff_t stride = 0;  // texels beyond the width are infinite
    std::size_t first = 0;      // into texels_
  };
  void lay_out(int width, int height);
  [[nodiscard]] const float* row(const Level& level, int y) const noexcept {
    return texels_.data() + level.first + static_cast<std::size_t>(y * level.stride);
  }
  [[nodiscard]] bool any_visible_at(int level, const PixelRect& rect, const Diagonals& diagonals, float nearest) const;

  // All levels are empty outside of it.
  PixelRect drawn_;
  bool cleared_ = true;  // by the last begin()
  std::vector<Level> levels_;
  std::vector<float> texels_;
};

}  // namespace occlod
