#include "io/file_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace occlod {

MeshFormat format_of(const std::filesystem::path& path, const FileErrors& errors) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".ply") return MeshFormat::ply;
  if (extension == ".obj") return MeshFormat::obj;
  if (extension == ".off") return MeshFormat::off;
  if (extension == ".stl") return MeshFormat::stl;
  if (extension == ".gltf" || extension == ".glb") return MeshFormat::gltf;
  errors.fail("",
              extension.empty() ? "has no extension" : fmt::format("the extension {} is unknown", in_quotes(extension)),
              "use .ply, .obj, .off, .stl or, to read, .gltf or .glb");
}

}  // namespace occlod
