// Exact z-buffer rasterisation on the CPU: one sample at each pixel centre, watertight (top-left rule), clipped at the
// near plane, both sides of every triangle. Shared by the software occlusion backend and by everything that measures or
// draws pictures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/core/ids.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// How near each pixel is, linear over the image of a plane, rows from the top: in perspective 1 / w, where w is the
// distance from the eye plane; drawn through an affine matrix, which is orthographic, from 1 on the near plane to 0 on
// the far plane. 0 = nothing there.
struct DepthBuffer {
  int width = 0;
  int height = 0;
  std::vector<float> nearness;  // width * height

  void reset(int new_width, int new_height);  // resizes and empties; reuses memory
};

// The same in memory of the caller's, row y at nearness + y * stride. A stride that is a multiple of 1024 makes
// drawing a third slower: the pixels of a column then share their place in the cache.
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

inline constexpr std::uint32_t no_item = no_id;

// Depth, and which triangle owns each pixel.
struct ItemBuffer {
  DepthBuffer depth;
  std::vector<std::uint32_t> items;  // width * height; no_item = background

  void reset(int width, int height);
};

// Draws triangles of `positions` (object space) through object_to_clip (OpenGL clip space). Nearer wins; at equal depth
// the one drawn first. What is orthographic and beyond the far plane is not drawn. Triangles with a corner that is not
// finite after transformation are skipped. O(triangles + pixels covered).
void draw_depth(DepthBuffer& target, std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                const glm::mat4& object_to_clip);
// Returns a rectangle that holds every pixel drawn.
PixelRect draw_depth(const DepthImage& target, std::span<const glm::vec3> positions,
                     std::span<const Triangle> triangles, const glm::mat4& object_to_clip);

// The same, and triangle i of the call owns its pixels as item first_item + i.
void draw_items(ItemBuffer& target, std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                const glm::mat4& object_to_clip, std::uint32_t first_item);

// Which items own at least one pixel, and how many. item_count: items are < item_count.
[[nodiscard]] std::vector<bool> visible_items(const ItemBuffer& buffer, std::size_t item_count);
[[nodiscard]] std::size_t count_visible_items(const ItemBuffer& buffer, std::size_t item_count);

}  // namespace occlod
