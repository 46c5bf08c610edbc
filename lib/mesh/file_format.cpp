#include "mesh/file_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace occlod {

namespace {

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace

std::optional<MeshFormat> find_format(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  if (extension == ".ply") return MeshFormat::ply;
  if (extension == ".obj") return MeshFormat::obj;
  if (extension == ".off") return MeshFormat::off;
  if (extension == ".stl") return MeshFormat::stl;
  if (extension == ".gltf" || extension == ".glb") return MeshFormat::gltf;
  return std::nullopt;
}

MeshFormat format_of(const std::filesystem::path& path, const FileErrors& errors) {
  if (const std::optional<MeshFormat> format = find_format(path)) return *format;
  const std::string extension = extension_of(path);
  errors.fail("",
              extension.empty() ? "has no extension" : fmt::format("the extension {} is unknown", in_quotes(extension)),
              "use .ply, .obj, .off, .stl or, to read, .gltf or .glb");
}

}  // namespace occlod
