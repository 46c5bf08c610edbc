#include "occlod/item_buffer.h"

#include <algorithm>
#include <cassert>
#include <string>

#include "occlod/base.h"
#include "raster/depth_image.h"
#include "raster/rasterizer.h"

namespace occlod {

void DepthBuffer::reset(int new_width, int new_height) {
  assert(new_width >= 0 && new_height >= 0);
  width = new_width;
  height = new_height;
  nearness.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.0F);
}

void ItemBuffer::reset(int width, int height) {
  depth.reset(width, height);
  items.assign(depth.nearness.size(), no_item);
}

void read_depth(DepthBuffer& target, std::span<const float> depth, const View& view, ClipDepth clip,
                bool rows_from_bottom) {
  const auto width = static_cast<std::size_t>(view.width()), height = static_cast<std::size_t>(view.height());
  if (depth.size() != width * height)
    throw Error({"picture", "", "has " + std::to_string(depth.size()) + " depths",
                 "give one for each of " + std::to_string(width) + " x " + std::to_string(height) + " pixels"});
  const double near = view.camera().near, far = view.camera().far;
  // Nearness is linear in depth.
  const double nearest = view.is_orthographic() ? 1.0 : 1.0 / near, farthest = view.is_orthographic() ? 0.0 : 1.0 / far;
  const bool reversed = clip == ClipDepth::one_to_zero;
  constexpr double step = 1.0 / (1 << 24);
  const auto slope = static_cast<float>((reversed ? 1.0 : -1.0) * (nearest - farthest));
  const auto at_zero = static_cast<float>((reversed ? farthest : nearest) - 2.0 * step * (nearest - farthest));
  target.width = view.width();
  target.height = view.height();
  target.nearness.resize(depth.size());
  for (std::size_t y = 0; y < height; ++y) {
    const float* from = depth.data() + (rows_from_bottom ? height - 1 - y : y) * width;
    float* to = target.nearness.data() + y * width;
    for (std::size_t x = 0; x < width; ++x) {
      const float nearness = at_zero + slope * from[x];
      to[x] = nearness > 0.0F ? nearness : 0.0F;  // not a number becomes empty
    }
  }
}

void draw_depth(DepthBuffer& target, std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                const glm::mat4& object_to_clip) {
  draw_depth(DepthImage{target.nearness.data(), target.width, target.height, target.width}, positions, triangles,
             object_to_clip);
}

PixelRect draw_depth(const DepthImage& target, std::span<const glm::vec3> positions,
                     std::span<const Triangle> triangles, const glm::mat4& object_to_clip) {
  DrawnPixels drawn;
  raster::Rasterizer(object_to_clip, target.width, target.height, raster::DepthWriter<false>{target, &drawn})
      .draw(positions, triangles, 0);
  return drawn.rect;
}

DrawnPixels draw_depth_counted(const DepthImage& target, std::span<const glm::vec3> positions,
                               std::span<const Triangle> triangles, const glm::mat4& object_to_clip) {
  DrawnPixels drawn;
  raster::Rasterizer(object_to_clip, target.width, target.height, raster::DepthWriter<true>{target, &drawn})
      .draw(positions, triangles, 0);
  return drawn;
}

void draw_items(ItemBuffer& target, std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                const glm::mat4& object_to_clip, std::uint32_t first_item) {
  draw_items_counted(target, positions, triangles, object_to_clip, first_item);
}

DrawnPixels draw_items_counted(ItemBuffer& target, std::span<const glm::vec3> positions,
                               std::span<const Triangle> triangles, const glm::mat4& object_to_clip,
                               std::uint32_t first_item) {
  DepthBuffer& depth = target.depth;
  DrawnPixels drawn;
  const raster::ItemWriter writer{
      depth.nearness.data(), target.items.data(), static_cast<std::size_t>(depth.width), {}, &drawn};
  raster::Rasterizer(object_to_clip, depth.width, depth.height, writer).draw(positions, triangles, first_item);
  return drawn;
}

std::vector<bool> visible_items(const ItemBuffer& buffer, std::size_t item_count) {
  std::vector<bool> seen(item_count);
  for (const std::uint32_t item : buffer.items) {
    if (item == no_item) continue;
    assert(item < item_count);
    seen[item] = true;
  }
  return seen;
}

std::size_t count_visible_items(const ItemBuffer& buffer, std::size_t item_count) {
  const std::vector<bool> seen = visible_items(buffer, item_count);
  return static_cast<std::size_t>(std::count(seen.begin(), seen.end(), true));
}

}  // namespace occlod
