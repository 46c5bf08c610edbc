// Triangles given directly in pixels, for tests of the rasteriser.
#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <random>
#include <span>

#include "occlod/item_buffer.h"

namespace occlod::test {

// Maps (x, y, *) in pixels from the top left to that place on an image of the given size, with w = 1.
inline glm::mat4 pixel_to_clip(int width, int height) {
  glm::mat4 m(0.0F);
  m[0][0] = 2.0F / static_cast<float>(width);
  m[3][0] = -1.0F;
  m[1][1] = -2.0F / static_cast<float>(height);
  m[3][1] = 1.0F;
  m[3][3] = 1.0F;
  return m;
}

// A coordinate that is a multiple of 1 / fraction pixels, fraction <= 256, so that snapping leaves it where it is.
inline float coordinate(std::mt19937& random, int low, int high, int fraction) {
  return static_cast<float>(std::uniform_int_distribution<int>(low * fraction, high * fraction)(random)) /
         static_cast<float>(fraction);
}

// How often each pixel is covered, one triangle at a time.
inline std::vector<int> count_coverage(std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                                       const glm::mat4& to_clip, int width, int height) {
  std::vector<int> count(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  DepthBuffer depth;
  for (const Triangle& triangle : triangles) {
    depth.reset(width, height);
    draw_depth(depth, positions, {&triangle, 1}, to_clip);
    for (std::size_t i = 0; i < count.size(); ++i) count[i] += depth.nearness[i] > 0.0F ? 1 : 0;
  }
  return count;
}

}  // namespace occlod::test
