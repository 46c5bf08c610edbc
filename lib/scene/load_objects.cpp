#include <fmt/format.h>

#include <optional>
#include <utility>

#include "occlod/io/olod.h"
#include "occlod/scene/scene.h"
#include "scene/build_cache.h"
#include "scene/mesh_source.h"
#include "scene/user_folders.h"

namespace occlod {
namespace {

using SharedHierarchy = std::shared_ptr<const Hierarchy>;

std::string describe(const BuildOptions& options) {
  return fmt::format("base_triangles={} boundary_weight={} measured={}", options.base_triangles,
                     options.boundary_weight, options.error_bound == ErrorBound::measured);
}

class Loader {
 public:
  Loader(const std::filesystem::path& folder, const LoadOptions& options) : folder_(folder), options_(options) {
    if (options.use_cache) cache_.emplace(user_cache_folder(), options.note);
  }

  LoadedObject load(const SceneObject& object, const SceneDescription& scene, std::size_t index) {
    LoadedObject result;
    result.object_to_world = object.object_to_world;
    result.two_sided = object.two_sided;
    result.attributes = object.attributes;
    result.source_name = name_of_source(object.source, scene, index, folder_);
    SharedHierarchy& shared = loaded_[result.source_name];
    if (!shared)
      shared = std::visit([&](const auto& source) { return load_source(source, result.source_name); }, object.source);
    result.hierarchy = shared;
    return result;
  }

 private:
  SharedHierarchy load_source(const MeshFile& source, const std::string& name) {
    if (is_olod_file(name)) return std::make_shared<const Hierarchy>(read_olod(name).hierarchy);
    const std::string key = cache_ ? cache_key_of_file(name, describe(options_.build)) : "";
    return find_or_build(key, source, name);
  }
  template <class Generator>
  SharedHierarchy load_source(const Generator& options, const std::string& name) {
    const std::string key = cache_ ? cache_key_of_text(name, describe(options_.build)) : "";
    return find_or_build(key, options, name);
  }

  SharedHierarchy find_or_build(const std::string& key, const MeshSource& source, const std::string& name) {
    if (cache_)
      if (auto found = cache_->find_hierarchy(key)) return std::make_shared<const Hierarchy>(*std::move(found));
    const CleanMesh input = read_source(source, name, options_.progress);
    auto hierarchy = std::make_shared<const Hierarchy>(build_hierarchy(input.mesh, build_options(name)));
    if (cache_) cache_->store(key, *hierarchy, input.report);
    return hierarchy;
  }

  BuildOptions build_options(const std::string& name) const {
    BuildOptions build = options_.build;
    build.progress = [this, name](double done) {
      if (options_.progress) options_.progress(name, done);
      return !options_.build.progress || options_.build.progress(done);
    };
    return build;
  }

  const std::filesystem::path& folder_;
  const LoadOptions& options_;
  std::optional<BuildCache> cache_;
  std::map<std::string, SharedHierarchy> loaded_;  // by source_name
};

}  // namespace

std::vector<LoadedObject> load_objects(const SceneDescription& scene, const std::filesystem::path& folder,
                                       const LoadOptions& options) {
  Loader loader(folder, options);
  std::vector<LoadedObject> objects;
  for (const SceneObject& object : scene.objects) objects.push_back(loader.load(object, scene, objects.size()));
  return objects;
}

}  // namespace occlod
