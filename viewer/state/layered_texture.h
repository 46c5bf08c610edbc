// Holds the materials of a mesh as images of one size, as OpenGL draws them in one call.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "occlod/mesh.h"
#include "occlod/picture.h"

namespace occlod::viewer {

struct LayeredTexture {
  int size = 1;               // pixels along each side of every layer
  std::vector<Image> layers;  // per material, its image times its base colour
  TextureOrigin origin = TextureOrigin::bottom_left;
};

// Reduces images larger than 2,048 pixels, or than 2^26 pixels in all allow, and enlarges others to the size of the
// largest. Returns null without materials. O(pixels).
[[nodiscard]] std::shared_ptr<const LayeredTexture> layered(std::span<const DrawMaterial> materials,
                                                            TextureOrigin origin);

// Returns a material's image times its base colour, `width` x `height` pixels. O(pixels).
[[nodiscard]] Image resampled(const DrawMaterial& material, int width, int height, TextureOrigin origin);

}  // namespace occlod::viewer
