#include "cells/cell_images.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/mat4x4.hpp>
#include <limits>

#include "cells/cell_geometry.h"
#include "cells/hull.h"

namespace occlod {
namespace {

constexpr std::uint32_t group_size = 128;  // triangles that are drawn at once

// The first pixel whose middle is not before the share of the half image, in [-1, 1].
int first_pixel(double share, int size) {
  return static_cast<int>(std::clamp(std::ceil(0.5 * size * (share + 1.0) - 0.5), 0.0, static_cast<double>(size)));
}

}  // namespace

CellImages::CellImages(const CellSurface& surface) : surface_(surface) {
  for (int i = 0; i < size; ++i) {
    const double step = (2.0 * i + 1.0) / size - 1.0;
    steps_[static_cast<std::size_t>(i)] = step;
    inverse_steps_[static_cast<std::size_t>(i)] = 1.0 / step;
  }
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    sides_[i].axis = static_cast<int>(i / 2);
    sides_[i].sign = i % 2 == 0 ? 1.0 : -1.0;
  }
}

void CellImages::draw(const CellBox& cell, double near_reach) {
  cell_ = cell;
  eye_ = 0.5 * (cell.min + cell.max);
  near_reach_ = near_reach;
  near_ = std::max({near_reach, 1e-9 * surface_.largest_coordinate(), std::numeric_limits<double>::min()});
  for (Side& side : sides_) draw(side);
}

void CellImages::draw(Side& side) {
  side.nearness.assign(static_cast<std::size_t>(size) * stride, 0.0F);
  side.farthest.assign(static_cast<std::size_t>(tiles) * tiles, 0.0F);
  side.farthest_known.assign(static_cast<std::size_t>(tiles) * tiles, true);
  surface_.bvh().for_each_group(
      eye_, group_size, [&](const TriangleBvh::Group& group) { return show(side, group.box); },
      [&](const TriangleBvh::Group& group) { draw_group(side, group); });
}

void CellImages::draw_group(Side& side, const TriangleBvh::Group& group) {
  positions_.clear();
  triangles_.clear();
  for (std::uint32_t t = group.first; t < group.first + group.count; ++t) {
    const glm::dvec3 &a = surface_.corner(t, 0), &b = surface_.corner(t, 1), &c = surface_.corner(t, 2);
    if (triangle_meets(a, b, c, grown(cell_, surface_.moved(t) + near_reach_))) continue;
    const auto first = static_cast<VertexId>(positions_.size());
    for (const glm::dvec3& p : {a, b, c}) positions_.emplace_back(p - eye_);
    triangles_.emplace_back(first, first + 1, first + 2);
  }
  // Depth is what w is; two axes of the world are those of the image.
  glm::mat4 to_clip(0.0F);
  const auto sign = static_cast<float>(side.sign);
  to_clip[(side.axis + 1) % 3].x = 1.0F;
  to_clip[(side.axis + 2) % 3].y = -1.0F;  // rows from the top
  to_clip[side.axis].z = to_clip[side.axis].w = sign;
  to_clip[3].z = static_cast<float>(-2.0 * near_);
  const PixelRect drawn = draw_depth({side.nearness.data(), size, size, stride}, positions_, triangles_, to_clip);
  if (drawn.empty()) return;
  for (int y = drawn.y0 / tile_size; y * tile_size < drawn.y1; ++y)
    for (int x = drawn.x0 / tile_size; x * tile_size < drawn.x1; ++x)
      side.farthest_known[static_cast<std::size_t>(y * tiles + x)] = false;
}

CellImages::Image CellImages::image_of(const Side& side, const CellBox& what) const {
  Image image;
  for (int k = 0; k < 3; ++k) {
    const int axis = (side.axis + 1 + k) % 3;
    image.min[k] = what.min[axis] - eye_[axis];
    image.max[k] = what.max[axis] - eye_[axis];
  }
  if (side.sign < 0.0) {
    std::swap(image.min.z, image.max.z);
    image.min.z = -image.min.z;
    image.max.z = -image.max.z;
  }
  image.min.z = std::max(image.min.z, near_);
  if (image.max.z < image.min.z) return image;
  const glm::dvec3 &low = image.min, &high = image.max;
  image.rect = {first_pixel(std::min(low.x / low.z, low.x / high.z), size),
                first_pixel(std::min(low.y / low.z, low.y / high.z), size),
                first_pixel(std::max(high.x / low.z, high.x / high.z), size),
                first_pixel(std::max(high.y / low.z, high.y / high.z), size)};
  return image;
}

bool CellImages::show(const CellBox& what) {
  return std::any_of(sides_.begin(), sides_.end(), [&](Side& side) { return show(side, what); });
}

bool CellImages::show(Side& side, const CellBox& what) {
  const Image image = image_of(side, what);
  if (image.rect.empty()) return false;
  for (int y = image.rect.y0; y < image.rect.y1;) {
    const int end_y = std::min((y / tile_size + 1) * tile_size, image.rect.y1);
    for (int x = image.rect.x0; x < image.rect.x1;) {
      const int end_x = std::min((x / tile_size + 1) * tile_size, image.rect.x1);
      if (static_cast<double>(farthest(side, x / tile_size, y / tile_size)) * image.min.z <= 1.0 &&
          shows_in_tile(side, image, {x, y, end_x, end_y}))
        return true;
      x = end_x;
    }
    y = end_y;
  }
  return false;
}

// A ray is in the box from where it has passed the last of three planes to where it passes the first of three others.
bool CellImages::shows_in_tile(const Side& side, const Image& image, const PixelRect& rect) const {
  for (int y = rect.y0; y < rect.y1; ++y) {
    const double by_row = inverse_steps_[static_cast<std::size_t>(y)];
    const bool down = by_row > 0.0;
    const double enter_row = std::max(image.min.z, (down ? image.min.y : image.max.y) * by_row);
    const double leave_row = std::min(image.max.z, (down ? image.max.y : image.min.y) * by_row);
    const float* const nearness = side.nearness.data() + static_cast<std::ptrdiff_t>(y) * stride;
    for (int x = rect.x0; x < rect.x1; ++x) {
      const double by_column = inverse_steps_[static_cast<std::size_t>(x)];
      const bool right = by_column > 0.0;
      const double enter = std::max(enter_row, (right ? image.min.x : image.max.x) * by_column);
      const double leave = std::min(leave_row, (right ? image.max.x : image.min.x) * by_column);
      if (enter <= leave && static_cast<double>(nearness[x]) * enter <= 1.0) return true;
    }
  }
  return false;
}

float CellImages::farthest(Side& side, int x, int y) {
  const auto tile = static_cast<std::size_t>(y * tiles + x);
  if (side.farthest_known[tile]) return side.farthest[tile];
  const float* const first = side.nearness.data() + (static_cast<std::ptrdiff_t>(y) * stride + x) * tile_size;
  float least = *first;
  for (int row = 0; row < tile_size; ++row)
    for (int column = 0; column < tile_size; ++column)
      least = std::min(least, first[static_cast<std::ptrdiff_t>(row) * stride + column]);
  side.farthest[tile] = least;
  side.farthest_known[tile] = true;
  return least;
}

}  // namespace occlod
