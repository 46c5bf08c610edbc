#include "image_file.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_STDIO
#include <stb_image.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <vector>

#include "base/file_input.h"
#include "occlod/base.h"

namespace occlod::tool {
namespace {

constexpr std::int64_t max_pixels = std::int64_t{1} << 28U;
constexpr char remedy[] = "convert it to PNG or JPEG, or draw without textures";

}  // namespace

Image decode_image(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw Error({name, "", "is too large for an image", remedy});
  const auto size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) == 0)
    throw Error({name, "", "is no image that can be read", remedy});
  if (std::int64_t{width} * height > max_pixels) throw Error({name, "", "is too large for an image", remedy});
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 4), stbi_image_free);
  if (!pixels) throw Error({name, "", std::string("cannot be decoded: ") + stbi_failure_reason(), remedy});
  Image image{width, height, {}};
  image.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::memcpy(image.pixels.data(), pixels.get(), 4 * image.pixels.size());
  return image;
}

Image read_image(const std::filesystem::path& file) {
  require_no_special_file(file);
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error({file.string(), "", "the image cannot be opened", "put it there, or draw without textures"});
  const std::vector<char> bytes((std::istreambuf_iterator<char>(stream)), {});
  return decode_image({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, file.string());
}

}  // namespace occlod::tool
