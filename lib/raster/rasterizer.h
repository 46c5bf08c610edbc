// Draws triangles one after the other into depth images and item buffers.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "raster/clip.h"
#include "raster/depth_image.h"
#include "raster/projection.h"

namespace occlod::raster {

// Calls write(pixel - begin, nearness) for the pixels [begin, end) of a row.
template <class Write>
inline void for_each_depth(const TriangleSetup& triangle, std::int32_t row, std::int32_t begin, std::int32_t end,
                           Write write) {
  const float smallest = triangle.depth.smallest;
  const float largest = triangle.depth.largest;
  for (std::int32_t from = begin; from < end;) {
    const DepthRow depth = triangle.depth_row(from, row);
    const std::int32_t to = triangle.small ? end : std::min(end, depth.origin + depth_reach);
    for (std::int32_t i = from; i < to; ++i) {
      float z = (depth.start + depth.step * static_cast<float>(i - depth.origin)) + depth.row_term;
      z = z > smallest ? z : smallest;
      write(i - begin, z < largest ? z : largest);
    }
    from = to;
  }
}

PixelRect rect_of(const TriangleSetup& triangle) {
  return {triangle.first_column, triangle.first_row, triangle.end_column, triangle.end_row};
}

// Writes spans to a depth image.
template <bool counts>
struct DepthWriter {
  DepthImage image;
  DrawnPixels* drawn;  // extended by each span

  // Returns true when it has drawn all triangles that need no clipping.
  bool draw_batch(const TriangleBatch& batch) const {
    if constexpr (counts) return draw_depth_batch_counted(batch, image, *drawn);
    return draw_depth_batch(batch, image, drawn->rect);
  }

  void draw(const TriangleSetup& triangle, std::uint32_t) const {
    drawn->rect = united(drawn->rect, rect_of(triangle));
    scan(triangle, image.width, image.rows, [&](std::int32_t row, std::int32_t begin, std::int32_t end) {
      drawn->fragments += static_cast<std::uint64_t>(end - begin);
      float* depth = image.nearness + row * image.stride + begin;
      for_each_depth(triangle, row, begin, end,
                     [=](std::int32_t i, float z) { depth[i] = depth[i] < z ? z : depth[i]; });
    });
  }
};

// Writes spans to an item buffer.
struct ItemWriter {
  float* nearness;
  std::uint32_t* items;
  std::size_t width;
  RowRange rows;
  DrawnPixels* drawn;  // extended by each span

  static bool draw_batch(const TriangleBatch&) { return false; }

  void draw(const TriangleSetup& triangle, std::uint32_t item) const {
    drawn->rect = united(drawn->rect, rect_of(triangle));
    scan(triangle, static_cast<int>(width), rows, [&](std::int32_t row, std::int32_t begin, std::int32_t end) {
      drawn->fragments += static_cast<std::uint64_t>(end - begin);
      const std::size_t first = static_cast<std::size_t>(row) * width + static_cast<std::size_t>(begin);
      float* depth = nearness + first;
      std::uint32_t* owner = items + first;
      for_each_depth(triangle, row, begin, end, [=](std::int32_t i, float z) {
        const bool nearer = z > depth[i];
        owner[i] = nearer ? item : owner[i];
        depth[i] = nearer ? z : depth[i];
      });
    });
  }
};

// Draws through `writer`; triangle i of the call is item first_item + i.
template <class Writer>
class Rasterizer {
 public:
  Rasterizer(const glm::mat4& object_to_clip, int width, int height, Writer writer)
      : projection_(object_to_clip, width, height), width_(width), height_(height), writer_(writer) {}

  void draw(std::span<const glm::vec3> positions, std::span<const Triangle> triangles, std::uint32_t first_item) {
    for (std::size_t first = 0; first < triangles.size(); first += batch_triangles) {
      projection_.project(positions, triangles.subspan(first, std::min(batch_triangles, triangles.size() - first)),
                          batch_);
      draw_batch([&](std::size_t i) { return first_item + static_cast<std::uint32_t>(first + i); });
    }
  }
  // Draws one to batch_triangles triangles, each with its item.
  void draw(std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
            std::span<const std::uint32_t> items) {
    projection_.project(positions, triangles, batch_);
    draw_batch([&](std::size_t i) { return items[i]; });
  }

 private:
  template <class ItemOf>
  void draw_batch(const ItemOf& item_of) {
    const bool drawn = writer_.draw_batch(batch_);
    for (std::size_t i = 0; i < batch_.size; ++i) {
      if ((batch_.drawable[0][i] & batch_.drawable[1][i] & batch_.drawable[2][i]) != 0) {
        if (!drawn)
          draw_triangle(batch_.screen_vertex(0, i), batch_.screen_vertex(1, i), batch_.screen_vertex(2, i), item_of(i));
      } else {
        draw_clipped({batch_.clip_position(0, i), batch_.clip_position(1, i), batch_.clip_position(2, i)}, item_of(i));
      }
    }
  }

  void draw_triangle(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c, std::uint32_t item) {
    TriangleSetup setup;
    if (set_up(a, b, c, width_, height_, setup)) writer_.draw(setup, item);
  }

  void draw_clipped(const std::array<glm::dvec4, 3>& triangle, std::uint32_t item) {
    const ClipPolygon polygon = clip_triangle(triangle, projection_.guard());
    std::array<ScreenVertex, largest_clip_polygon> corners;
    for (std::size_t i = 0; i < polygon.size; ++i) {
      if (!(polygon.corners[i].w > 0.0)) return;
      corners[i] = projection_.snap(polygon.corners[i]);
    }
    for (std::size_t i = 2; i < polygon.size; ++i) draw_triangle(corners[0], corners[i - 1], corners[i], item);
  }

  Projection projection_;
  TriangleBatch batch_;
  int width_;
  int height_;
  Writer writer_;
};

}  // namespace occlod::raster
