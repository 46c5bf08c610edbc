// Counts how many pixels of boxes pass the depth test, between draws, without drawing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "raster/depth_image.h"
#include "raster/projected_box.h"

namespace occlod::raster {

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
