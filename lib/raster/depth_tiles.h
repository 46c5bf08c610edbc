// Boxes on the screen: which pixels they cover, each once, and how near they are there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "raster/depth_image.h"

namespace occlod::raster {

// A box, or what an affine map makes of it, wholly before the near plane.
struct ProjectedBox {
  // Numbered as by corner(). x, y: pixels from the top left of the image; z: nearness, see DepthBuffer.
  std::array<glm::dvec3, 8> corners{};
  bool mirrored = false;  // the map from box to clip space turns right-handed into left-handed
};

// The pixels of an image whose centres a box covers. Reuses its memory.
class BoxOutline {
 public:
  struct Span {
    std::int32_t begin = 0, end = 0;  // columns [begin, end); begin <= end
  };

  // Throws away what it held. O(rows covered).
  void assign(const ProjectedBox& box, int width, int height);

  // Rows [first_row(), end_row()) have spans.
  [[nodiscard]] std::int32_t first_row() const noexcept { return first_row_; }
  [[nodiscard]] std::int32_t end_row() const noexcept { return first_row_ + static_cast<std::int32_t>(spans_.size()); }
  [[nodiscard]] const Span& span(std::int32_t row) const noexcept {
    return spans_[static_cast<std::size_t>(row - first_row_)];
  }
  // Of all rows.
  [[nodiscard]] std::uint32_t pixels() const noexcept { return pixels_; }

 private:
  struct Crossing {
    double left, right;
  };

  std::int32_t first_row_ = 0;
  std::vector<Crossing> crossings_;
  std::vector<Span> spans_;
  std::uint32_t pixels_ = 0;
};

// Nearness of the front of a box, pixel by pixel. A ray enters a convex body where it has passed the last of the planes
// that face it: the least near.
class BoxFront {
 public:
  explicit BoxFront(const ProjectedBox& box);

  struct Plane {
    double at_origin, per_column, per_row;  // at the centre of pixel (0, 0)
  };
  // At most three faces of a box face an eye; those beyond are so near everywhere that they do not count.
  static constexpr std::size_t max_planes = 3;

  // On one row. Rounding keeps the order: where a plane rises from pixel to pixel, so does what is computed.
  struct Row {
    std::array<double, max_planes> start, step;
    double least, most;

    [[nodiscard]] double at(double column) const noexcept {
      double z = most;
      for (std::size_t i = 0; i < max_planes; ++i) {
        const double plane = start[i] + step[i] * column;
        z = z < plane ? z : plane;
      }
      return z > least ? z : least;
    }
  };
  [[nodiscard]] Row row(std::int32_t y) const noexcept {
    Row row{{}, {}, least_, most_};
    for (std::size_t i = 0; i < max_planes; ++i) {
      row.start[i] = planes_[i].at_origin + planes_[i].per_row * y;
      row.step[i] = planes_[i].per_column;
    }
    return row;
  }

  struct Range {
    double least, most;
  };
  // No pixel of columns [x0, x1) x rows [y0, y1), not empty, has a nearness outside of it.
  [[nodiscard]] Range range(std::int32_t x0, std::int32_t y0, std::int32_t x1, std::int32_t y1) const noexcept;

 private:
  std::array<Plane, max_planes> planes_;
  double least_, most_;
};

// Counts how many pixels of boxes pass the depth test, between draws, without drawing.

struct DepthCount {
  std::uint32_t passed = 0;   // pixels at which nothing is nearer than the box
  std::uint32_t covered = 0;  // by the box
};

// A depth image cut into squares. The nearest and the farthest depth of a square decide about many boxes without
// looking at its pixels; they are found when they are first asked for after something has been drawn there.
class DepthTiles {
 public:
  static constexpr int size = 16;  // pixels a side

  // An image of which nothing is known. It is the caller's, and stays where it is until the next begin().
  void begin(const DepthImage& image);
  // Something has been drawn inside the rectangle.
  void change(const PixelRect& drawn);
  // Exact, whatever the tiles. O(rows + tiles of the box + pixels of the tiles that do not decide).
  [[nodiscard]] DepthCount count(const ProjectedBox& box);

 private:
  struct Tile {
    float farthest = 0.0F, nearest = 0.0F;
    bool known = false;
  };

  [[nodiscard]] const Tile& tile(int x, int y);
  [[nodiscard]] std::uint32_t count_in_band(const BoxFront& front, std::int32_t first_row, std::int32_t end_row);
  [[nodiscard]] std::uint32_t count_in_tile(const BoxFront& front, const PixelRect& rect);
  [[nodiscard]] std::uint32_t covered_in(const PixelRect& rect) const;

  DepthImage image_;
  int columns_ = 0;
  std::vector<Tile> tiles_;
  BoxOutline outline_;  // of the box that is counted
};

}  // namespace occlod::raster
