// Packs shapes, such as the charts of a tile, closely into one image: what fits into the hollows of others lies there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace occlod::tiles {

// A set of squares of a grid.
class Shape {
 public:
  Shape() = default;
  // None of width x height squares, both > 0.
  Shape(int width, int height);

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  // Adds the squares [x0, x1) of row y, within the grid.
  void add(int y, int x0, int x1) noexcept;
  [[nodiscard]] bool has(int x, int y) const noexcept {
    const auto at = static_cast<std::size_t>(x);
    return (row(y)[at / 64] >> (at % 64) & 1U) != 0;
  }
  // Counts the squares. O(grid / 64).
  [[nodiscard]] std::uint64_t count() const noexcept;
  // Returns a row, 64 squares a word, the first in the lowest bit.
  [[nodiscard]] std::span<const std::uint64_t> row(int y) const noexcept;

 private:
  int width_ = 0, height_ = 0, words_ = 0;  // a row
  std::vector<std::uint64_t> bits_;
};

// Where shapes lie in an image, in squares.
struct Packing {
  glm::ivec2 size{0};
  std::vector<glm::ivec2> at;  // by shape, of its square (0, 0)
};

// Packs the shapes so that none overlaps another, the largest first, each as high as possible and then as far left, in
// images of several widths, and returns the smallest, none much wider than high. The same shapes give the same. About
// O(n height runs), where runs is the number of gaps in a row.
[[nodiscard]] Packing pack_shapes(std::span<const Shape> shapes);

}  // namespace occlod::tiles
