#include "occlod/item_buffer.h"

#include <algorithm>
#include <cassert>
#include <string>

#include "occlod/base.h"
#include "raster/clip.h"
#include "raster/depth_image.h"
#include "raster/projection.h"

namespace occlod {
namespace {

using raster::ScreenVertex;
using raster::TriangleBatch;
using raster::TriangleSetup;

// Calls write(pixel - begin, nearness) for the pixels [begin, end) of a row.
template <class Write>
inline void for_each_depth(const TriangleSetup& triangle, std::int32_t row, std::int32_t begin, std::int32_t end,
                           Write write) {
  const float smallest = triangle.depth.smallest;
  const float largest = triangle.depth.largest;
  for (std::int32_t from = begin; from < end;) {
    const raster::DepthRow depth = triangle.depth_row(from, row);
    const std::int32_t to = triangle.small ? end : std::min(end, depth.origin + raster::depth_reach);
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
    if constexpr (counts) return raster::draw_depth_batch_counted(batch, image, *drawn);
    return raster::draw_depth_batch(batch, image, drawn->rect);
  }

  void draw(const TriangleSetup& triangle, std::uint32_t) const {
    drawn->rect = united(drawn->rect, rect_of(triangle));
    raster::scan(triangle, image.width, [&](std::int32_t row, std::int32_t begin, std::int32_t end) {
      drawn->fragments += static_cast<std::uint64_t>(end - begin);
      float* depth = image.nearness + row * image.stride + begin;
      for_each_depth(triangle, row, begin, end,
                     [=](std::int32_t i, float z) { depth[i] = depth[i] < z ? z : depth[i]; });
    });
  }
};

struct ItemWriter {
  float* nearness;
  std::uint32_t* items;
  std::size_t width;
  DrawnPixels* drawn;  // extended by each span

  static bool draw_batch(const TriangleBatch&) { return false; }

  void draw(const TriangleSetup& triangle, std::uint32_t item) const {
    drawn->rect = united(drawn->rect, rect_of(triangle));
    raster::scan(triangle, static_cast<int>(width), [&](std::int32_t row, std::int32_t begin, std::int32_t end) {
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
    TriangleBatch batch;
    for (std::size_t first = 0; first < triangles.size(); first += raster::batch_triangles) {
      projection_.project(positions,
                          triangles.subspan(first, std::min(raster::batch_triangles, triangles.size() - first)), batch);
      draw_batch(batch, first_item + static_cast<std::uint32_t>(first));
    }
  }

 private:
  void draw_batch(const TriangleBatch& batch, std::uint32_t first_item) {
    const bool drawn = writer_.draw_batch(batch);
    for (std::size_t i = 0; i < batch.size; ++i) {
      const std::uint32_t item = first_item + static_cast<std::uint32_t>(i);
      if ((batch.drawable[0][i] & batch.drawable[1][i] & batch.drawable[2][i]) != 0) {
        if (!drawn)
          draw_triangle(batch.screen_vertex(0, i), batch.screen_vertex(1, i), batch.screen_vertex(2, i), item);
      } else {
        draw_clipped({batch.clip_position(0, i), batch.clip_position(1, i), batch.clip_position(2, i)}, item);
      }
    }
  }

  void draw_triangle(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c, std::uint32_t item) {
    raster::TriangleSetup setup;
    if (raster::set_up(a, b, c, width_, height_, setup)) writer_.draw(setup, item);
  }

  void draw_clipped(const std::array<glm::dvec4, 3>& triangle, std::uint32_t item) {
    const raster::ClipPolygon polygon = raster::clip_triangle(triangle, projection_.guard());
    std::array<ScreenVertex, raster::largest_clip_polygon> corners;
    for (std::size_t i = 0; i < polygon.size; ++i) {
      if (!(polygon.corners[i].w > 0.0)) return;
      corners[i] = projection_.snap(polygon.corners[i]);
    }
    for (std::size_t i = 2; i < polygon.size; ++i) draw_triangle(corners[0], corners[i - 1], corners[i], item);
  }

  raster::Projection projection_;
  int width_;
  int height_;
  Writer writer_;
};

}  // namespace

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
  Rasterizer(object_to_clip, target.width, target.height, DepthWriter<false>{target, &drawn})
      .draw(positions, triangles, 0);
  return drawn.rect;
}

DrawnPixels draw_depth_counted(const DepthImage& target, std::span<const glm::vec3> positions,
                               std::span<const Triangle> triangles, const glm::mat4& object_to_clip) {
  DrawnPixels drawn;
  Rasterizer(object_to_clip, target.width, target.height, DepthWriter<true>{target, &drawn})
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
  const ItemWriter writer{depth.nearness.data(), target.items.data(), static_cast<std::size_t>(depth.width), &drawn};
  Rasterizer(object_to_clip, depth.width, depth.height, writer).draw(positions, triangles, first_item);
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
