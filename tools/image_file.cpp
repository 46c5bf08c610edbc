#include "image_file.h"

#include <fstream>
#include <iterator>
#include <vector>

#include "base/file_input.h"
#include "mesh/image_codec.h"
#include "occlod/base.h"

namespace occlod::tool {

Image decode_image(std::span<const std::uint8_t> bytes, const std::string& name) {
  const Texels texels = decode_texels(bytes, name);
  return {texels.width, texels.height, {texels.pixels.begin(), texels.pixels.end()}};
}

Image read_image(const std::filesystem::path& file) {
  require_no_special_file(file);
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error({file.string(), "", "the image cannot be opened", "put it there, or draw without textures"});
  const std::vector<char> bytes((std::istreambuf_iterator<char>(stream)), {});
  return decode_image({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, file.string());
}

}  // namespace occlod::tool
