#include "layered_texture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace occlod::viewer {
namespace {

constexpr unsigned largest_size = 2048;
constexpr std::uint64_t max_pixels = std::uint64_t{1} << 26U;

std::uint8_t to_srgb(float linear) {
  const float v = std::clamp(linear, 0.0F, 1.0F);
  return static_cast<std::uint8_t>(
      std::lround(255.0F * (v <= 0.0031308F ? 12.92F * v : 1.055F * std::pow(v, 1.0F / 2.4F) - 0.055F)));
}

glm::u8vec4 to_srgb(const glm::vec3& linear) { return {to_srgb(linear.x), to_srgb(linear.y), to_srgb(linear.z), 255}; }

// Returns a power of two.
unsigned layer_size(std::span<const DrawMaterial> materials) {
  unsigned size = 1;
  for (const DrawMaterial& material : materials)
    if (material.image != nullptr)
      size = std::max(size, static_cast<unsigned>(std::max(material.image->width(), material.image->height())));
  size = std::min(std::bit_ceil(size), largest_size);
  while (size > 1 && std::uint64_t{size} * size * materials.size() > max_pixels) size /= 2;
  return size;
}

}  // namespace

Image resampled(const DrawMaterial& material, int width, int height, TextureOrigin origin) {
  Image image{width, height, {}};
  image.pixels.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const glm::dvec2 step(1.0 / width, 1.0 / height);
  for (int y = 0; y < height; ++y) {
    const double down = (y + 0.5) * step.y;
    for (int x = 0; x < width; ++x) {
      const glm::dvec2 at((x + 0.5) * step.x, origin == TextureOrigin::bottom_left ? 1.0 - down : down);
      const glm::vec3 color =
          material.image == nullptr ? glm::vec3(1.0F) : material.image->sample(at, {step.x, 0.0}, {0.0, step.y});
      image.pixels.push_back(to_srgb(material.base_color * color));
    }
  }
  return image;
}

std::shared_ptr<const LayeredTexture> layered(std::span<const DrawMaterial> materials, TextureOrigin origin) {
  if (materials.empty()) return nullptr;
  auto result = std::make_shared<LayeredTexture>();
  result->size = static_cast<int>(layer_size(materials));
  result->origin = origin;
  for (const DrawMaterial& material : materials)
    result->layers.push_back(resampled(material, result->size, result->size, origin));
  return result;
}

}  // namespace occlod::viewer
