#include "visibility/scene_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "occlod/visibility.h"
#include "refine/tuning.h"

namespace occlod::bench {
namespace {

// The name of the first mesh of the scene that no file is found for, or nothing.
std::string missing_mesh(const SceneDescription& scene, const std::filesystem::path& folder) {
  for (const SceneObject& object : scene.objects) {
    const auto* file = std::get_if<MeshFile>(&object.source);
    if (file == nullptr) continue;
    const bool found = std::any_of(file->names.begin(), file->names.end(),
                                   [&](const std::string& name) { return !find_mesh(name, folder).empty(); });
    if (!found) return file->names.front();
  }
  return {};
}

}  // namespace

SceneRun::SceneRun(SceneDescription scene, tool::RenderInput input)
    : description(std::move(scene)),
      objects(std::move(input.objects)),
      view(input.camera),
      without(objects),
      with(objects),
      software(make_software_occlusion()) {}

std::filesystem::path scene_file(const std::string& name) {
  const bool is_file = std::filesystem::path(name).extension() == ".json";
  return is_file ? std::filesystem::path(name) : std::filesystem::path(OCCLOD_SCENES) / (name + ".json");
}

std::unique_ptr<SceneRun> load_scene(const std::filesystem::path& file, const std::optional<tool::ImageSize>& size) {
  SceneDescription scene = read_scene(file);
  if (const std::string missing = missing_mesh(scene, file.parent_path()); !missing.empty()) {
    fmt::print(stderr, "SKIPPED: {}: {} is in no folder of OCCLOD_MESHES\n", scene.name, missing);
    return nullptr;
  }
  tool::RenderInputOptions input;
  input.file = file;
  input.size = size;
  return std::make_unique<SceneRun>(std::move(scene), tool::load_render_input(input));
}

double Share::percent() const {
  return 100.0 * static_cast<double>(visible) / static_cast<double>(std::max<std::size_t>(triangles, 1));
}

Share measure_share(tool::Measurement& measurement, const View& view, const RefineOptions& options,
                    Visibility& visibility) {
  measurement.begin();
  measurement.repeat(view, options, visibility);
  return {measurement.refinement().stats.triangles, measurement.visible_triangles(),
          fmt::format("{:016x}", measurement.refinement().hash())};
}

double improvement(std::size_t visible, std::size_t start) {
  return 100.0 * (static_cast<double>(visible) / static_cast<double>(std::max<std::size_t>(start, 1)) - 1.0);
}

RefineOptions refine_options(std::size_t budget, Culling culling) {
  RefineOptions options;
  options.budget = budget;
  tune(options).culling = culling;
  if (culling == Culling::subtree) {
    tune(options).occluder_splits = {300, 2500};
    tune(options).proxy = Proxy::cylinder;
    tune(options).final_check = false;
  }
  return options;
}

}  // namespace occlod::bench
