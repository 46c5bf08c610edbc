// Depth images in the caller's memory, rectangles of their pixels, and drawing into them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

#include "occlod/item_buffer.h"
#include "occlod/mesh.h"

namespace occlod {

// The rows [first, end), all by default. What is drawn of a triangle in one range of rows and in another is what would
// be drawn in both at once, to the bit.
struct RowRange {
  int first = 0;
  int end = std::numeric_limits<int>::max();

  [[nodiscard]] bool meets(const RowRange& other) const noexcept { return first < other.end && other.first < end; }
};

// Pixels as in a DepthBuffer, with row y at nearness + y * stride. A stride that is a multiple of 1024 makes drawing a
// third slower, because the pixels of a column then map to the same cache set.
struct DepthImage {
  float* nearness = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  // >= width
  RowRange rows = {};         // that may be drawn
};

// The pixels [x0, x1) x [y0, y1).
struct PixelRect {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;

  [[nodiscard]] bool empty() const noexcept { return (x0 >= x1) | (y0 >= y1); }
};

// Returns the smallest rectangle that contains both; an empty one adds nothing.
[[nodiscard]] constexpr PixelRect united(const PixelRect& a, const PixelRect& b) noexcept {
  if (a.x0 >= a.x1 || a.y0 >= a.y1) return b;
  if (b.x0 >= b.x1 || b.y0 >= b.y1) return a;
  return {a.x0 < b.x0 ? a.x0 : b.x0, a.y0 < b.y0 ? a.y0 : b.y0, a.x1 > b.x1 ? a.x1 : b.x1, a.y1 > b.y1 ? a.y1 : b.y1};
}

// Draws as draw_depth() into a DepthBuffer does. Returns a rectangle that contains every pixel drawn.
PixelRect draw_depth(const DepthImage& target, std::span<const glm::vec3> positions,
                     std::span<const Triangle> triangles, const glm::mat4& object_to_clip);

struct DrawnPixels {
  PixelRect rect;               // contains every pixel drawn
  std::uint64_t fragments = 0;  // covered pixels of all triangles, whether they pass the depth test or not
};

// Draws as draw_depth() does and counts fragments.
DrawnPixels draw_depth_counted(const DepthImage& target, std::span<const glm::vec3> positions,
                               std::span<const Triangle> triangles, const glm::mat4& object_to_clip);
// Draws as draw_items() does and counts fragments.
DrawnPixels draw_items_counted(ItemBuffer& target, std::span<const glm::vec3> positions,
                               std::span<const Triangle> triangles, const glm::mat4& object_to_clip,
                               std::uint32_t first_item);

}  // namespace occlod
