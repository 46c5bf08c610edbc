// Depth images in memory of the caller's, and rectangles of their pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "occlod/item_buffer.h"
#include "occlod/mesh.h"

namespace occlod {

// What a DepthBuffer holds, row y at nearness + y * stride. A stride that is a multiple of 1024 makes drawing a third
// slower: the pixels of a column then share their place in the cache.
struct DepthImage {
  float* nearness = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  // >= width
};

// Pixels [x0, x1) x [y0, y1).
struct PixelRect {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;

  [[nodiscard]] bool empty() const noexcept { return (x0 >= x1) | (y0 >= y1); }
};

// The smallest rectangle around both; an empty one adds nothing.
[[nodiscard]] constexpr PixelRect united(const PixelRect& a, const PixelRect& b) noexcept {
  if (a.x0 >= a.x1 || a.y0 >= a.y1) return b;
  if (b.x0 >= b.x1 || b.y0 >= b.y1) return a;
  return {a.x0 < b.x0 ? a.x0 : b.x0, a.y0 < b.y0 ? a.y0 : b.y0, a.x1 > b.x1 ? a.x1 : b.x1, a.y1 > b.y1 ? a.y1 : b.y1};
}

// As draw_depth() into a DepthBuffer. Returns a rectangle that holds every pixel drawn.
PixelRect draw_depth(const DepthImage& target, std::span<const glm::vec3> positions,
                     std::span<const Triangle> triangles, const glm::mat4& object_to_clip);

struct DrawnPixels {
  PixelRect rect;               // holds every pixel drawn
  std::uint64_t fragments = 0;  // pixels covered, those of each triangle, whether they pass the depth test or not
};

// The same with a count.
DrawnPixels draw_depth_counted(const DepthImage& target, std::span<const glm::vec3> positions,
                               std::span<const Triangle> triangles, const glm::mat4& object_to_clip);
// As draw_items(), with a count.
DrawnPixels draw_items_counted(ItemBuffer& target, std::span<const glm::vec3> positions,
                               std::span<const Triangle> triangles, const glm::mat4& object_to_clip,
                               std::uint32_t first_item);

}  // namespace occlod
