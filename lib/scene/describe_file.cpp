#include <algorithm>
#include <cctype>

#include "occlod/core/error.h"
#include "occlod/scene/scene.h"

namespace occlod {
namespace fs = std::filesystem;

bool is_scene_file(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".json";
}

SceneDescription describe_file(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (!fs::exists(status)) throw Error({path.string(), "", "no such file", "check the path"});
  if (fs::is_directory(status))
    throw Error({path.string(), "", "is a folder", "name a scene (.json), a mesh or a hierarchy (.olod) in it"});
  if (!fs::is_regular_file(status))
    throw Error({path.string(), "", "is not a regular file", "save it to a file first"});
  if (is_scene_file(path)) return read_scene(path);
  SceneDescription scene;
  scene.name = path.stem().string();
  scene.file = path;
  scene.objects.push_back({.source = MeshFile{{fs::absolute(path).string()}}});
  return scene;
}

}  // namespace occlod
