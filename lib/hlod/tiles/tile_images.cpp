#include "hlod/tiles/tile_images.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <system_error>

#include "mesh/mesh_writers.h"

namespace occlod::tiles {
namespace {

namespace fs = std::filesystem;

// Nothing when it cannot be read.
std::optional<std::string> bytes_of(const Texture& texture, const fs::path& folder) {
  if (!texture.bytes.empty()) return std::string(texture.bytes.begin(), texture.bytes.end());
  std::error_code error;
  const fs::path file = folder / texture.file;
  if (!fs::is_regular_file(file, error)) return std::nullopt;
  std::ifstream stream(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad() || bytes.empty()) return std::nullopt;
  return bytes;
}

// Of what the first bytes say, whatever the file is called; empty for what glTF does not know.
std::string extension_of(const std::string& bytes) {
  Texture texture;
  texture.bytes.assign(bytes.begin(),
                       bytes.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(bytes.size(), 16)));
  const std::string type = mime_type_of(texture);
  return type == "image/png" ? ".png" : type == "image/jpeg" ? ".jpg" : "";
}

}  // namespace

TileLook write_images(AtomicFolder& folder, const hlod::HlodView& hlod, const fs::path& image_folder,
                      std::vector<std::string>& left_out) {
  TileLook look{hlod.materials, hlod.textures, {}, hlod.texture_origin};
  std::map<std::string, std::string> written;  // from the name of a file to its uri
  for (const Texture& texture : hlod.textures) {
    std::string& uri = look.images.emplace_back();
    const bool is_file = texture.bytes.empty();
    if (const auto known = written.find(texture.file); is_file && known != written.end()) {
      uri = known->second;
      continue;
    }
    const std::size_t number = look.images.size() - 1;
    const std::optional<std::string> bytes = bytes_of(texture, image_folder);
    const std::string extension = bytes ? extension_of(*bytes) : "";
    if (extension.empty()) {
      left_out.push_back(is_file ? texture.file : fmt::format("image {}", number));
    } else {
      const std::string name = fmt::format("textures/{}{}", number, extension);
      folder.write(name, *bytes);
      uri = "../../" + name;
    }
    if (is_file) written[texture.file] = uri;
  }
  return look;
}

}  // namespace occlod::tiles
