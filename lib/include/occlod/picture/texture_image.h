// Images to be laid over surfaces in pictures. Who decodes image files is up to the program.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "occlod/core/ids.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// An image in memory.
struct Image {
  int width = 0;                    // pixels
  int height = 0;                   // pixels
  std::vector<glm::u8vec4> pixels;  // width * height, sRGB and alpha, rows from the top
};

// How texture coordinates address an image.
struct TextureAddress {
  TextureWrap wrap_s = TextureWrap::repeat;           // along the first coordinate
  TextureWrap wrap_t = TextureWrap::repeat;           // along the second
  TextureOrigin origin = TextureOrigin::bottom_left;  // where (0, 0) is
};

// An image and smaller versions of it, to be sampled at any scale. Immutable.
class TextureImage {
 public:
  // An image of at least one pixel. The smaller versions, each half the size, average light; alpha is left out.
  // O(pixels) time; memory is a third more than the image's.
  explicit TextureImage(Image image, const TextureAddress& address = {});

  // In pixels.
  [[nodiscard]] int width() const noexcept { return levels_[0].width; }
  // In pixels.
  [[nodiscard]] int height() const noexcept { return levels_[0].height; }

  // Linear RGB at a texture coordinate. across, down: how much the coordinate changes from one pixel of the picture to
  // the next. Bilinear within and between two sizes of the image, at up to 16 places along the longer of the two steps,
  // so that surfaces seen at a flat angle stay sharp. White where a number is not finite.
  [[nodiscard]] glm::vec3 sample(const glm::dvec2& coordinate, const glm::dvec2& across, const glm::dvec2& down) const;

 private:
  [[nodiscard]] glm::vec3 sample_level(const glm::dvec2& coordinate, std::size_t level) const;
  [[nodiscard]] glm::vec3 sample_between(const glm::dvec2& coordinate, double level) const;

  std::vector<Image> levels_;  // each half the size of the one before, down to one pixel
  TextureAddress address_;
};

// Squares, light and dark in turns, in colours that change from place to place: every slip is seen. squares: along each
// side, at least 1; square_px: pixels along each side of one, at least 1.
[[nodiscard]] Image checker_image(int squares = 32, int square_px = 32);

// How a surface looks, with the image that its material names.
struct DrawMaterial {
  glm::vec3 base_color{1.0F};           // linear RGB in [0, 1]
  const TextureImage* image = nullptr;  // multiplies it; null: none
};

// What is laid over one object. The spans need live only during a call.
struct ObjectTexture {
  std::span<const glm::vec2> coordinates = {};        // one per vertex that triangles index, or empty: no images
  std::span<const MaterialId> vertex_materials = {};  // one per vertex; a triangle's first corner says its material;
                                                      // empty: all have the first
  std::span<const DrawMaterial> materials = {};       // that vertex_materials index; empty: no texture
};

}  // namespace occlod
