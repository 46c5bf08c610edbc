#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO

#include <stb_image_write.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <exception>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>

#include "base/atomic_file.h"
#include "occlod/base.h"
#include "occlod/picture.h"
#include "scene/color.h"

namespace occlod {
namespace {

// Keeps an exception until the encoder, which is not exception-safe, has freed its memory.
struct Output {
  AtomicFile file;
  std::exception_ptr failure;
};

void append(void* to, void* data, int size) {
  Output& output = *static_cast<Output*>(to);
  try {
    output.file.write({static_cast<const std::byte*>(data), static_cast<std::size_t>(size)});
  } catch (...) {
    output.failure = std::current_exception();
  }
}

}  // namespace

void write_png(const std::filesystem::path& path, const Image& image) {
  assert(image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  Output output{AtomicFile(path), nullptr};
  if (stbi_write_png_to_func(append, &output, image.width, image.height, 4, image.pixels.data(), image.width * 4) == 0)
    throw Error({path.string(), "", "the picture cannot be encoded", "make it smaller"});
  if (output.failure) std::rethrow_exception(output.failure);
  output.file.commit();
}

namespace {

constexpr double max_taps = 16.0;  // along the longer footprint axis

const std::array<float, 256>& linear_of_byte() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values{};
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = picture::to_linear(static_cast<std::uint8_t>(i));
    return values;
  }();
  return table;
}

glm::vec3 linear_at(const Image& image, int x, int y) {
  const std::array<float, 256>& linear = linear_of_byte();
  const glm::u8vec4& p =
      image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)];
  return {linear[p.x], linear[p.y], linear[p.z]};
}

// Returns an image of half the size, rounded down, at least 1. Each pixel is the mean of those that it covers.
Image halved(const Image& image) {
  Image half{std::max(image.width / 2, 1), std::max(image.height / 2, 1), {}};
  half.pixels.reserve(static_cast<std::size_t>(half.width) * static_cast<std::size_t>(half.height));
  for (int y = 0; y < half.height; ++y) {
    const int y0 = y * image.height / half.height, y1 = (y + 1) * image.height / half.height;
    for (int x = 0; x < half.width; ++x) {
      const int x0 = x * image.width / half.width, x1 = (x + 1) * image.width / half.width;
      glm::vec3 sum(0.0F);
      for (int j = y0; j < y1; ++j)
        for (int i = x0; i < x1; ++i) sum += linear_at(image, i, j);
      half.pixels.push_back(picture::to_srgb(sum / static_cast<float>((x1 - x0) * (y1 - y0))));
    }
  }
  return half;
}

// Returns the pixel of a row of `size` that pixel i of the infinitely repeated row shows.
int wrapped(double i, int size, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp) return static_cast<int>(std::clamp(i, 0.0, size - 1.0));
  const double period = wrap == TextureWrap::mirror ? 2.0 * size : size;
  const auto within = static_cast<int>(i - period * std::floor(i / period));
  return within < size ? within : std::max(2 * size - 1 - within, 0);
}

bool is_finite(const glm::dvec2& v) { return std::isfinite(v.x) && std::isfinite(v.y); }

glm::vec3 hue(float turn) {
  const glm::vec3 offset(0.0F, 2.0F / 3.0F, 1.0F / 3.0F);
  const glm::vec3 t = glm::abs(glm::fract(turn + offset) * 6.0F - 3.0F) - 1.0F;
  return glm::clamp(t, 0.0F, 1.0F);
}

}  // namespace

TextureImage::TextureImage(Image image, const TextureAddress& address) : address_(address) {
  assert(image.width > 0 && image.height > 0);
  assert(image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  levels_.push_back(std::move(image));
  while (levels_.back().width > 1 || levels_.back().height > 1) levels_.push_back(halved(levels_.back()));
}

glm::vec3 TextureImage::sample(const glm::dvec2& coordinate, const glm::dvec2& across, const glm::dvec2& down) const {
  if (!is_finite(coordinate) || !is_finite(across) || !is_finite(down)) return glm::vec3(1.0F);
  const glm::dvec2 size(levels_[0].width, levels_[0].height);
  const double a = glm::length(across * size), b = glm::length(down * size);
  const double major = std::max({a, b, 1e-9}), minor = std::max(std::min(a, b), 1e-9);
  const double taps = std::clamp(std::ceil(major / std::max(minor, 1.0)), 1.0, max_taps);
  const double level = std::log2(std::max(major / taps, 1.0));
  const glm::dvec2 along = a >= b ? across : down;
  glm::vec3 sum(0.0F);
  for (int i = 0; i < static_cast<int>(taps); ++i)
    sum += sample_between(coordinate + ((i + 0.5) / taps - 0.5) * along, level);
  return sum / static_cast<float>(taps);
}

glm::vec3 TextureImage::sample_between(const glm::dvec2& coordinate, double level) const {
  const double most = static_cast<double>(levels_.size()) - 1.0;
  const double low = std::floor(std::min(level, most));
  const auto index = static_cast<std::size_t>(low);
  const auto part = static_cast<float>(std::min(level, most) - low);
  const glm::vec3 fine = sample_level(coordinate, index);
  return part > 0.0F ? glm::mix(fine, sample_level(coordinate, index + 1), part) : fine;
}

glm::vec3 TextureImage::sample_level(const glm::dvec2& coordinate, std::size_t level) const {
  const Image& image = levels_[level];
  const double t = address_.origin == TextureOrigin::bottom_left ? 1.0 - coordinate.y : coordinate.y;
  // The centre of pixel i is at i + 1/2.
  const double x = coordinate.x * image.width - 0.5, y = t * image.height - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  const int x0 = wrapped(left, image.width, address_.wrap_s), x1 = wrapped(left + 1.0, image.width, address_.wrap_s);
  const int y0 = wrapped(top, image.height, address_.wrap_t), y1 = wrapped(top + 1.0, image.height, address_.wrap_t);
  const auto fx = static_cast<float>(x - left), fy = static_cast<float>(y - top);
  return glm::mix(glm::mix(linear_at(image, x0, y0), linear_at(image, x1, y0), fx),
                  glm::mix(linear_at(image, x0, y1), linear_at(image, x1, y1), fx), fy);
}

Image checker_image(int squares, int square_px) {
  assert(squares >= 1 && square_px >= 1);
  const int size = squares * square_px;
  Image image{size, size, {}};
  image.pixels.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const int column = x / square_px, row = y / square_px;
      const float along = static_cast<float>(column) / static_cast<float>(squares);
      const float down = static_cast<float>(row) / static_cast<float>(squares);
      const glm::vec3 color = glm::mix(glm::vec3(1.0F), hue(along + 0.5F * down), 0.3F + 0.5F * down);
      image.pixels.push_back(picture::to_srgb((column + row) % 2 == 0 ? color : 0.12F * color));
    }
  }
  return image;
}

}  // namespace occlod
