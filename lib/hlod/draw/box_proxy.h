// The grown box that every device draws in place of a box that it is asked about: one proxy, whatever counts its
// pixels.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include "hlod/draw/proxy_space.h"
#include "occlod/math/bounds.h"
#include "raster/projected_box.h"

namespace occlod {

struct BoxProxy {
  enum class Kind {
    beside,     // touches no pixel: before the near plane or beside the image; counts 0
    drawn,      // what follows is filled in
    uncertain,  // not finite, inside out, crosses the near plane, or reaches farther than 65,536 pixels from the middle
                // of the image; counts all pixels of the image
  };
  Kind kind = Kind::uncertain;

  glm::dmat4 unit_to_clip{1.0};  // from the cube [-1, 1]^3; not turned round for mirrored objects
  raster::ProjectedBox image;    // its corners in pixels and nearness
  glm::dvec2 min{0.0};           // of the corners, pixels
  glm::dvec2 max{0.0};           // likewise
};

// The space of one object in a view, for boxes of it. With the matrix of clip_matrix().
[[nodiscard]] ProxySpace proxy_space(const Screen& screen, const View& view, const ObjectView& object);

// The proxy of a box in object space, grown() so that it covers the sample of every pixel at which anything inside the
// box can show. O(1).
[[nodiscard]] BoxProxy project_box(const Screen& screen, const ProxySpace& space, const Box& box);

// Pixels that the proxy covers on an empty screen: what a query would count. `outline` is scratch. O(rows covered).
[[nodiscard]] std::uint32_t covered_pixels(const Screen& screen, const BoxProxy& proxy, raster::BoxOutline& outline);

}  // namespace occlod
