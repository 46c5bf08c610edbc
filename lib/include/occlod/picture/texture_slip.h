// How far textures are, in a picture, from where the picture of the full mesh has them.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "occlod/picture/picture.h"
#include "occlod/picture/texture_image.h"
#include "occlod/raster/item_buffer.h"
#include "occlod/view/view.h"

namespace occlod {

// What part of a texture a pixel shows at its centre.
struct Texel {
  std::uint64_t surface = 0;   // objects and materials are told apart by it; 0: no texture coordinates here
  glm::dvec2 coordinate{0.0};  // of the texture
  glm::dvec2 across{0.0};      // by how much it changes from a pixel to the next one to the right
  glm::dvec2 down{0.0};        // to the next one below
};

// The texels of a picture.
struct TexelBuffer {
  int width = 0;              // pixels
  int height = 0;             // pixels
  std::vector<Texel> texels;  // width * height, rows from the top
};

// Of what draw_items() drew of these objects in this view. textures: one for each object; images are not needed.
// O(pixels).
[[nodiscard]] TexelBuffer find_texels(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view,
                                      std::span<const ObjectTexture> textures);

// What a pixel's slip counts at most.
inline constexpr double largest_slip_px = 10.0;

// The root mean square over the pixels that have texels in both pictures: how far each texel of `shown` is from the
// nearest place at which `full` shows it, between pixels by its change across them, at most largest_slip_px. 0 where
// they are equal; none when no pixel has texels in both. Pixels of `full` around which the coordinate does not change
// in both directions, but for rounding, say nothing of where a texel should be, and do not count. Both have the same
// size. O(pixels * slip^2).
[[nodiscard]] std::optional<double> texture_slip_px(const TexelBuffer& shown, const TexelBuffer& full);

}  // namespace occlod
