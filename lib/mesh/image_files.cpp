#include "mesh/image_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "mesh/mesh_files.h"

namespace occlod {
namespace {

namespace fs = std::filesystem;

struct ImageFormat {
  std::string_view type;
  std::string_view extension;       // of files
  std::size_t offset;               // of the bytes that tell it
  std::string_view bytes;           // empty: none do
  std::string_view gltf_extension;  // "-": glTF lacks it
};

constexpr const char* unknown_type = "application/octet-stream";

constexpr std::array<ImageFormat, 10> formats{{
    {"image/png", ".png", 0, "\x89PNG", ""},
    {"image/jpeg", ".jpg", 0, "\xff\xd8", ""},
    {"image/jpeg", ".jpeg", 0, "\xff\xd8", ""},
    {"image/webp", ".webp", 8, "WEBP", "EXT_texture_webp"},
    {"image/ktx2", ".ktx2", 0, "\xabKTX 20\xbb", "KHR_texture_basisu"},
    {"image/vnd-ms.dds", ".dds", 0, "DDS ", "MSFT_texture_dds"},
    {"image/avif", ".avif", 4, "ftypavif", "EXT_texture_avif"},
    {"image/bmp", ".bmp", 0, "BM", "-"},
    {"image/gif", ".gif", 0, "GIF8", "-"},
    {"image/x-tga", ".tga", 0, "", "-"},
}};

bool begins_with(std::span<const std::uint8_t> bytes, std::size_t offset, std::string_view what) {
  return !what.empty() && bytes.size() >= offset + what.size() &&
         std::ranges::equal(what, bytes.subspan(offset, what.size()),
                            [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

bool is_file(const fs::path& path) {
  std::error_code unknown;
  return fs::is_regular_file(path, unknown);
}

}  // namespace

fs::path folder_of(const fs::path& file) {
  const fs::path folder = file.parent_path();
  return folder.empty() ? "." : folder;
}

fs::path image_path(const std::string& file, const fs::path& folder) { return folder / name_in(folder, file); }

std::string name_that_leads(const std::string& file, const ImageFolders& folders) {
  if (file.empty() || folders.from.empty()) return file;
  const fs::path image = image_path(file, folders.from);
  std::error_code error;
  if (!is_file(image) || fs::equivalent(folders.from, folders.to, error)) return file;
  const fs::path folder = fs::canonical(folder_of(image), error);
  const fs::path to = fs::weakly_canonical(folders.to.empty() ? "." : folders.to, error);
  if (error) return file;
  const fs::path whole = folder / image.filename(), near = whole.lexically_relative(to);
  return (near.empty() ? whole : near).generic_string();
}

void lead_to_images(std::vector<Texture>& textures, const ImageFolders& folders) {
  for (Texture& texture : textures) texture.file = name_that_leads(texture.file, folders);
}

std::optional<ImageBytes> read_image(const Texture& texture, const fs::path& folder) {
  if (!texture.bytes.empty()) return ImageBytes(texture.bytes.begin(), texture.bytes.end());
  const fs::path path = image_path(texture.file, folder);
  if (!is_file(path)) return std::nullopt;
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (error || size == 0) return std::nullopt;
  ImageBytes bytes(size);
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size))) return std::nullopt;
  return bytes;
}

std::optional<ImageBytes> find_image(const Texture& texture, const fs::path& folder) {
  if (!texture.bytes.empty()) return read_image(texture, folder);
  Texture wanted = texture;
  for (;;) {
    if (auto bytes = read_image(wanted, folder)) return bytes;
    const std::size_t slash = wanted.file.find_first_of("/\\");
    if (slash == std::string::npos) return std::nullopt;
    wanted.file.erase(0, slash + 1);
  }
}

std::string name_of_image(std::span<const Texture> textures, TextureId id) {
  return textures[id].bytes.empty() ? textures[id].file : fmt::format("image {}", id);
}

std::string image_type(std::span<const std::uint8_t> bytes, const std::string& file) {
  for (const ImageFormat& format : formats)
    if (begins_with(bytes, format.offset, format.bytes)) return std::string(format.type);
  std::string extension = fs::path(file).extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const ImageFormat& format : formats)
    if (extension == format.extension) return std::string(format.type);
  return unknown_type;
}

std::string image_type(const Texture& texture) {
  std::string type = image_type(texture.bytes, texture.file);
  return type == unknown_type && !texture.mime_type.empty() ? texture.mime_type : type;
}

std::string image_extension(const std::string& mime_type) {
  for (const ImageFormat& format : formats)
    if (mime_type == format.type) return std::string(format.extension);
  return mime_type.starts_with("image/") ? "." + mime_type.substr(6) : ".bin";
}

std::optional<std::string> gltf_image_extension(const std::string& mime_type) {
  for (const ImageFormat& format : formats)
    if (mime_type == format.type && format.gltf_extension != "-") return std::string(format.gltf_extension);
  return std::nullopt;
}

}  // namespace occlod
