// Exact z-buffer rasterisation on the CPU: one sample at each pixel centre, watertight (top-left rule), clipped at the
// near plane, both sides of every triangle. The software occlusion backend, measurements and pictures use it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/base.h"
#include "occlod/mesh.h"
#include "occlod/view.h"

namespace occlod {

// A depth image. Depth is stored as nearness, which is linear in screen space over a plane. In perspective it is 1 / w,
// where w is the distance from the eye plane in world units; through an affine matrix, which is orthographic, it runs
// from 1 on the near plane to 0 on the far plane. 0 means that the pixel is empty.
struct DepthBuffer {
  int width = 0;                // pixels
  int height = 0;               // pixels
  std::vector<float> nearness;  // width * height, rows from the top

  // Resizes the buffer and empties every pixel. Reuses its memory.
  void reset(int new_width, int new_height);
};

// Fills `target` with the depth that a graphics interface has written for a picture of `view`: one value a pixel from 0
// to 1, rows from the bottom (OpenGL) or from the top (Vulkan, Direct3D, Metal, WebGPU). 1 is on the far plane, or on
// the near one where `clip` is reversed. What steps of 24 bits leave open is rounded to farther. Throws Error when
// there are not width() * height() values. O(pixels).
void read_depth(DepthBuffer& target, std::span<const float> depth, const View& view, ClipDepth clip,
                bool rows_from_bottom);

// The item of background pixels.
inline constexpr std::uint32_t no_item = no_id;

// A depth image with the triangle that owns each pixel.
struct ItemBuffer {
  DepthBuffer depth;                 // of the nearest triangle at each pixel
  std::vector<std::uint32_t> items;  // width * height, rows from the top; no_item: background

  // Resizes the buffer and empties every pixel. Reuses its memory.
  void reset(int width, int height);
};

// Draws `triangles`, ids into `positions` (object space), through object_to_clip (OpenGL clip space). The nearer
// triangle wins; at equal depth the one drawn first. In orthographic views nothing beyond the far plane is drawn.
// Triangles with a corner that is not finite after transformation are skipped. O(triangles + pixels covered).
void draw_depth(DepthBuffer& target, std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                const glm::mat4& object_to_clip);

// Draws triangles as draw_depth() does; triangle i of the call owns its pixels as item first_item + i.
void draw_items(ItemBuffer& target, std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                const glm::mat4& object_to_clip, std::uint32_t first_item);

// Returns which items own at least one pixel. item_count is larger than every item. O(pixels + item_count).
[[nodiscard]] std::vector<bool> visible_items(const ItemBuffer& buffer, std::size_t item_count);
// Counts the items that own at least one pixel. item_count is larger than every item. O(pixels + item_count).
[[nodiscard]] std::size_t count_visible_items(const ItemBuffer& buffer, std::size_t item_count);

}  // namespace occlod
