#include "viewer/golden.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#pragma GCC diagnostic pop

#include <fmt/format.h>

#include <cstdlib>
#include <cstring>

namespace occlod::viewer::test {
namespace {

constexpr double max_mean = 1.5;  // of 255
constexpr int much = 24;          // of 255
constexpr double max_share_of_much = 0.02;

}  // namespace

Image read_png(const std::filesystem::path& file) {
  Image image;
  int channels = 0;
  stbi_uc* pixels = stbi_load(file.c_str(), &image.width, &image.height, &channels, 4);
  if (pixels == nullptr) return {};
  image.pixels.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  std::memcpy(image.pixels.data(), pixels, image.pixels.size() * sizeof(glm::u8vec4));
  stbi_image_free(pixels);
  return image;
}

std::string difference(const Image& found, const Image& expected) {
  if (found.width != expected.width || found.height != expected.height || found.pixels.empty())
    return fmt::format("{}x{} instead of {}x{} pixels", found.width, found.height, expected.width, expected.height);
  double sum = 0.0;
  double far_off = 0.0;
  for (std::size_t i = 0; i < found.pixels.size(); ++i) {
    int most = 0;
    for (int c = 0; c < 3; ++c) {
      const int off = std::abs(int{found.pixels[i][c]} - int{expected.pixels[i][c]});
      sum += off / 3.0;
      most = std::max(most, off);
    }
    far_off += most > much ? 1.0 : 0.0;
  }
  const auto count = static_cast<double>(found.pixels.size());
  if (sum / count <= max_mean && far_off / count <= max_share_of_much) return "";
  return fmt::format("differs by {:.2f} of 255 on average, by more than {} in {:.1f} % of its pixels", sum / count,
                     much, 100.0 * far_off / count);
}

}  // namespace occlod::viewer::test
