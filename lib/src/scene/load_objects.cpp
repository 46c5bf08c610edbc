#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>

#include "occlod/core/error.h"
#include "occlod/io/olod.h"
#include "occlod/io/read_mesh.h"
#include "occlod/mesh/clean.h"
#include "occlod/scene/scene.h"
#include "scene/hierarchy_cache.h"
#include "scene/mesh_folders.h"
#include "scene/user_folders.h"

namespace occlod {
namespace {

using SharedHierarchy = std::shared_ptr<const Hierarchy>;

// Name and options of a generator: shown to users, and everything that its mesh depends on.
std::string describe(const RoughPlanetOptions& o) {
  return fmt::format("rough-planet level={} seed={} amplitude={} frequency={} octaves={}", o.level, o.seed, o.amplitude,
                     o.frequency, o.octaves);
}
std::string describe(const CityOptions& o) {
  return fmt::format("city blocks={} facade_cells={} seed={}", o.blocks, o.facade_cells, o.seed);
}
std::string describe(const PipesOptions& o) {
  return fmt::format("pipes pipes={} bends={} sides={} seed={}", o.pipes, o.bends, o.sides, o.seed);
}
std::string describe(const SpheresBehindWallOptions& o) {
  return fmt::format("spheres-behind-wall spheres={} level={} wall_cells={} seed={}", o.spheres, o.level, o.wall_cells,
                     o.seed);
}

TriangleMesh generate(const RoughPlanetOptions& options) { return generate_rough_planet(options); }
TriangleMesh generate(const CityOptions& options) { return generate_city(options); }
TriangleMesh generate(const PipesOptions& options) { return generate_pipes(options); }
TriangleMesh generate(const SpheresBehindWallOptions& options) { return generate_spheres_behind_wall(options); }

std::string describe(const BuildOptions& options) {
  return fmt::format("base_triangles={} boundary_weight={} measured={}", options.base_triangles,
                     options.boundary_weight, options.error_bound == ErrorBound::measured);
}

bool is_olod(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension == ".olod";
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
    const Diagnosis missing{scene.file.empty() ? scene.name : scene.file.string(),
                            fmt::format("/objects/{}/mesh", index), "", ""};
    result.source_name = std::visit([&](const auto& source) { return name_of(source, missing); }, object.source);
    SharedHierarchy& shared = loaded_[result.source_name];
    if (!shared)
      shared = std::visit([&](const auto& source) { return load_source(source, result.source_name); }, object.source);
    result.hierarchy = shared;
    return result;
  }

 private:
  std::string name_of(const MeshFile& file, Diagnosis missing) const {
    for (const std::string& name : file.names)
      if (const std::filesystem::path path = find_mesh(name, folder_); !path.empty()) return path.string();
    std::vector<std::string> searched;
    for (const std::filesystem::path& folder : mesh_folders(folder_))
      searched.push_back(folder.empty() ? "." : folder.string());
    missing.problem =
        fmt::format("there is no file {}; searched: {}", fmt::join(file.names, " or "), fmt::join(searched, ", "));
    missing.remedy = "put it into one of these folders, or set OCCLOD_MESHES to the one that holds it";
    throw Error(missing);
  }
  template <class Generator>
  std::string name_of(const Generator& options, const Diagnosis&) const {
    return describe(options);
  }

  SharedHierarchy load_source(const MeshFile&, const std::string& name) {
    if (is_olod(name)) return std::make_shared<const Hierarchy>(read_olod(name).hierarchy);
    const std::string key = cache_ ? cache_key_of_file(name, describe(options_.build)) : "";
    return find_or_build(key, name, [&] {
      return read_mesh(name, [&](double done) {
        if (options_.progress) options_.progress("reading " + name, done);
      });
    });
  }
  template <class Generator>
  SharedHierarchy load_source(const Generator& options, const std::string& name) {
    const std::string key = cache_ ? cache_key_of_text(name, describe(options_.build)) : "";
    return find_or_build(key, name, [&] { return clean(generate(options), MeshReport{}, name); });
  }

  template <class MakeMesh>
  SharedHierarchy find_or_build(const std::string& key, const std::string& name, const MakeMesh& make_mesh) {
    if (cache_)
      if (auto found = cache_->find(key)) return std::make_shared<const Hierarchy>(*std::move(found));
    const CleanMesh input = make_mesh();
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
  std::optional<HierarchyCache> cache_;
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
