#include "occlod/scene/load_hlods.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "occlod/core/error.h"
#include "occlod/io/ohlod.h"
#include "scene/build_cache.h"
#include "scene/mesh_source.h"
#include "scene/user_folders.h"

namespace occlod {
namespace {

using SharedHlod = std::shared_ptr<const hlod::Hlod>;

std::string describe(const hlod::BuildOptions& options) {
  std::string text = fmt::format(
      "hlod node_triangles={} nested={} free={} splits={} boundary_weight={} attribute_weight={}",
      options.node_triangles, options.grouping == hlod::Grouping::nested, options.borders == hlod::Borders::free,
      options.within == hlod::Within::splits, options.boundary_weight, options.attribute_weight);
  if (options.quantise_bits != 0) text += fmt::format(" quantise_bits={}", options.quantise_bits);
  return text;
}

SharedHlod build(const SceneDescription& scene, const std::filesystem::path& folder, const HlodLoadOptions& options) {
  std::optional<BuildCache> cache;
  std::string key;
  if (options.use_cache) {
    cache.emplace(user_cache_folder(), options.note);
    key = cache_key_of_scene(scene, folder, describe(options.build));
    if (auto found = cache->find_hlod(key)) return std::make_shared<const hlod::Hlod>(*std::move(found));
  }
  const CleanMesh input = flatten_scene(scene, folder, options.progress);
  hlod::BuildOptions build = options.build;
  build.progress = [&](double done) {
    if (options.progress) options.progress("building " + scene.name, done);
    return !options.build.progress || options.build.progress(done);
  };
  auto hlod = std::make_shared<const hlod::Hlod>(build_hlod(input.mesh, build));
  if (cache) cache->store(key, *hlod, input.report);
  return hlod;
}

SharedHlod read(const std::string& file, const std::optional<hlod::CacheOptions>& paged) {
  if (paged) return std::make_shared<const hlod::Hlod>(open_ohlod(file, *paged).hlod);
  auto hlod = std::make_shared<const hlod::Hlod>(read_ohlod(file).hlod);
  hlod->require_all();
  return hlod;
}

// A file's share of the budget.
std::optional<hlod::CacheOptions> share_of(std::optional<hlod::CacheOptions> paged, const SceneDescription& scene,
                                           const std::filesystem::path& folder) {
  if (!paged) return paged;
  std::set<std::string> files;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const std::string name = name_of_source(scene.objects[i].source, scene, i, folder);
    if (!is_ohlod_file(name))
      throw Error({name, "", "is no .ohlod file, and only of those meshes can come and go",
                   "make one with 'occlod hlod build', or use no cache"});
    files.insert(name);
  }
  paged->budget_bytes /= std::max<std::size_t>(files.size(), 1);
  return paged;
}

}  // namespace

std::vector<LoadedHlod> load_hlods(const SceneDescription& scene, const std::filesystem::path& folder,
                                   const HlodLoadOptions& options) {
  SceneDescription meshes = scene;  // without the .ohlod files
  meshes.objects.clear();
  std::vector<LoadedHlod> hlods;
  std::map<std::string, SharedHlod> files;  // by name
  const std::optional<hlod::CacheOptions> paged = share_of(options.paged, scene, folder);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    const std::string name = name_of_source(object.source, scene, i, folder);
    if (!is_ohlod_file(name)) {
      meshes.objects.push_back(object);
      continue;
    }
    SharedHlod& shared = files[name];
    if (!shared) shared = read(name, paged);
    hlods.push_back({shared, object.object_to_world, object.two_sided, name});
  }
  if (meshes.objects.empty()) return hlods;
  const bool two_sided = std::any_of(meshes.objects.begin(), meshes.objects.end(),
                                     [](const SceneObject& object) { return object.two_sided; });
  hlods.insert(hlods.begin(), {build(meshes, folder, options), glm::dmat4(1.0), two_sided, scene.name});
  return hlods;
}

}  // namespace occlod
