#include "support/shipped_scenes.h"

#include <variant>

namespace occlod::test {

ShippedScene read_shipped_scene(const std::string& name) {
  const std::filesystem::path folder = OCCLOD_SCENES;
  return {folder, read_scene(folder / (name + ".json"))};
}

std::optional<std::string> missing_mesh(const ShippedScene& scene) {
  for (const SceneObject& object : scene.description.objects)
    if (const auto* file = std::get_if<MeshFile>(&object.source);
        file != nullptr && find_mesh(file->names.front(), scene.folder).empty())
      return file->names.front();
  return std::nullopt;
}

std::vector<LoadedObject> load_objects(const ShippedScene& scene) {
  LoadOptions options;
  options.use_cache = false;
  return occlod::load_objects(scene.description, scene.folder, options);
}

}  // namespace occlod::test
