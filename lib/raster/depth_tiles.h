// Depth tests of boxes without drawing: which pixels a box covers, how near it is there, and how many of them pass.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "raster/depth_image.h"

namespace occlod::raster {

// A box, or its image under an affine map, that lies wholly beyond the near plane.
struct ProjectedBox {
  // Corners in the order of corner(). x, y: pixels from the top left of the image; z: nearness, see DepthBuffer.
  std::array<glm::dvec3, 8> corners{};
  bool mirrored = false;  // the map from the box to clip space turns right-handed into left-handed
};

// The pixels of an image whose centres a box covers, as one span per row. Reuses its memory.
class BoxOutline {
 public:
  struct Span {
    std::int32_t begin = 0, end = 0;  // columns [begin, end); begin <= end
  };

  // Replaces the outline by that of `box`. O(rows covered).
  void assign(const ProjectedBox& box, int width, int height);

  // The rows [first_row(), end_row()) have spans.
  [[nodiscard]] std::int32_t first_row() const noexcept { return first_row_; }
  [[nodiscard]] std::int32_t end_row() const noexcept { return first_row_ + static_cast<std::int32_t>(spans_.size()); }
  [[nodiscard]] const Span& span(std::int32_t row) const noexcept {
    return spans_[static_cast<std::size_t>(row - first_row_)];
  }
  // Returns the number of covered pixels.
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

// Nearness of a box's front at each pixel. A ray enters a convex body at the last plane of its front faces, so the
// front has the smallest nearness of these planes.
class BoxFront {
 public:
  explicit BoxFront(const ProjectedBox& box);

  struct Plane {
    double at_origin, per_column, per_row;  // at_origin is the nearness at the centre of pixel (0, 0)
  };
  // At most three faces of a box face an eye; unused planes are infinitely near everywhere, so they do not count.
  static constexpr std::size_t max_planes = 3;

  // The planes on one row. Rounding keeps the order: where a plane rises from pixel to pixel, so do the computed
  // values.
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
  // Returns a range that contains the nearness of every pixel of columns [x0, x1) x rows [y0, y1), which are not empty.
  [[nodiscard]] Range range(std::int32_t x0, std::int32_t y0, std::int32_t x1, std::int32_t y1) const noexcept;

 private:
  std::array<Plane, max_planes> planes_;
  double least_, most_;
};

struct DepthCount {
  std::uint32_t passed = 0;   // covered pixels at which nothing is nearer than the box
  std::uint32_t covered = 0;  // pixels that the box covers
};

// Counts the pixels of boxes that pass the depth test, between draws, without drawing. The depth image is divided into
// square tiles, and the nearest and the farthest depth of a tile decide about many boxes without reading its pixels.
// They are computed when they are first needed after a draw into the tile.
class DepthTiles {
 public:
  static constexpr int size = 16;  // pixels a side

  // Starts with an image of unknown contents. The image is the caller's and must stay valid until the next begin().
  void begin(const DepthImage& image);
  // Must be called after drawing inside the rectangle.
  void change(const PixelRect& drawn);
  // Counts exactly; tiles only save time. O(rows + tiles of the box + pixels of the tiles that do not decide).
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
  BoxOutline outline_;  // of the box that is being counted
};

}  // namespace occlod::raster
