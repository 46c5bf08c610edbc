#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "base/file_input.h"
#include "mesh/mesh_files.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/node_store.h"
#include "occlod/scene.h"
#include "scene/builder_id.h"
#include "scene/find_mesh.h"
#include "scene/mesh_source.h"

namespace occlod {
namespace {

// Caches built hierarchies and HLODs in the user's cache folder.

// Throws only std::bad_alloc: a cache that cannot be used is reported to `note` and has no effect.
class BuildCache {
 public:
  BuildCache(std::filesystem::path folder, std::function<void(const std::string&)> note);

  // Finds an entry. Every part of the returned value has been checked. An entry that fails is reported to `note` and
  // removed.
  [[nodiscard]] std::optional<Hierarchy> find_hierarchy(const std::string& key) const;
  [[nodiscard]] std::optional<hlod::Hlod> find_hlod(const std::string& key) const;
  void store(const std::string& key, const Hierarchy& hierarchy, const MeshReport& report) const;
  void store(const std::string& key, const hlod::Hlod& hlod, const MeshReport& report) const;

 private:
  [[nodiscard]] std::filesystem::path path_of(const std::string& key, const char* extension) const {
    return folder_ / (key + extension);
  }
  template <class Read>
  auto find(const std::filesystem::path& path, const char* what, const Read& read) const
      -> std::optional<decltype(read(path))>;
  template <class Write>
  void store_by(const char* what, const Write& write) const;

  std::filesystem::path folder_;
  std::function<void(const std::string&)> note_;
};

namespace fs = std::filesystem;

class Hasher {
 public:
  Hasher() : state_(XXH3_createState(), &XXH3_freeState) { XXH3_128bits_reset(state_.get()); }
  void add(const void* bytes, std::size_t size) { XXH3_128bits_update(state_.get(), bytes, size); }
  // Also adds the length, so that what follows needs no separator.
  void add_file(const fs::path& path) {
    require_no_special_file(path);
    std::ifstream stream(path, std::ios::binary);
    std::array<char, 1 << 16> block;
    std::uint64_t bytes = 0;
    while (stream.read(block.data(), block.size()) || stream.gcount() > 0) {
      add(block.data(), static_cast<std::size_t>(stream.gcount()));
      bytes += static_cast<std::uint64_t>(stream.gcount());
    }
    if (!stream.eof()) throw Error({path.string(), "", "cannot be read", "check its permissions"});
    add(&bytes, sizeof(bytes));
  }
  [[nodiscard]] std::string hex() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
  }

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

// Comes first in every hash, so that what follows needs no separator.
void add_builder(Hasher& hasher, const std::string& build_options) {
  const std::string text = fmt::format("occlod {} builder {} olod {} ohlod {} {}\n", version(), builder_id,
                                       olod_version, ohlod_version, build_options);
  hasher.add(text.data(), text.size());
}

// Returns 32 hexadecimal digits that change whenever the result of the build might: they hash the bytes of the input
// (the content of a file and of those that it names, or a generator's options), the build options, the versions of the
// formats and of the builders' sources. Throws Error when the file cannot be read.
[[nodiscard]] std::string cache_key_of_text(const std::string& text, const std::string& build_options) {
  Hasher hasher;
  add_builder(hasher, build_options);
  hasher.add(text.data(), text.size());
  return hasher.hex();
}

[[nodiscard]] std::string cache_key_of_file(const fs::path& path, const std::string& build_options) {
  Hasher hasher;
  add_builder(hasher, build_options + path.extension().string());
  hasher.add_file(path);
  for (const fs::path& beside : files_beside(path)) hasher.add_file(beside);
  return hasher.hex();
}

// Returns the key for all objects of a scene together with their placements. Throws Error when a file cannot be read or
// a mesh cannot be found.
[[nodiscard]] std::string cache_key_of_scene(const SceneDescription& scene, const fs::path& folder,
                                             const std::string& build_options) {
  Hasher hasher;
  add_builder(hasher, build_options);
  std::map<std::string, std::string> keys;  // of the sources, by name
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    const std::string name = name_of_source(object.source, scene, i, folder);
    std::string& key = keys[name];
    if (key.empty())
      key = std::holds_alternative<MeshFile>(object.source) ? cache_key_of_file(name, "") : cache_key_of_text(name, "");
    hasher.add(key.data(), key.size());
    hasher.add(&object.object_to_world, sizeof(object.object_to_world));
  }
  return hasher.hex();
}

BuildCache::BuildCache(fs::path folder, std::function<void(const std::string&)> note)
    : folder_(std::move(folder)), note_(std::move(note)) {
  if (!note_) note_ = [](const std::string&) {};
}

// Checks all of the entry, because a block that is found damaged in the middle of a frame cannot be rebuilt there. That
// takes a tenth of a second for 120 MB, the largest hierarchy of the shipped scenes, which takes seconds to build.
template <class Read>
auto BuildCache::find(const fs::path& path, const char* what, const Read& read) const
    -> std::optional<decltype(read(path))> {
  std::error_code ignored;
  if (folder_.empty() || !fs::exists(fs::symlink_status(path, ignored))) return std::nullopt;
  try {
    if (!fs::is_regular_file(path, ignored)) throw Error({path.string(), "", "is not a regular file", ""});
    auto found = read(path);
    found.require_all();
    return found;
  } catch (const Error& error) {
    const auto& [file, place, problem, remedy] = error.diagnosis();
    note_(fmt::format("{} is built again: {}: {}{}{}", what, file, place, place.empty() ? "" : ": ", problem));
  }
  // Removes the old entry first: a folder cannot be replaced, and a replaced file would keep its permissions.
  fs::remove(path, ignored);
  return std::nullopt;
}

std::optional<Hierarchy> BuildCache::find_hierarchy(const std::string& key) const {
  return find(path_of(key, ".olod"), "a cached hierarchy",
              [](const fs::path& path) { return read_olod(path).hierarchy; });
}

std::optional<hlod::Hlod> BuildCache::find_hlod(const std::string& key) const {
  return find(path_of(key, ".ohlod"), "a cached HLOD", [](const fs::path& path) { return read_ohlod(path).hlod; });
}

template <class Write>
void BuildCache::store_by(const char* what, const Write& write) const {
  if (folder_.empty()) return note_("neither XDG_CACHE_HOME nor HOME names a folder: nothing is cached");
  try {
    fs::create_directories(folder_);
    write();
  } catch (const std::exception& error) {
    note_(fmt::format("{} is not cached: {}", what, error.what()));
  }
}

void BuildCache::store(const std::string& key, const Hierarchy& hierarchy, const MeshReport& report) const {
  store_by("the hierarchy", [&] { write_olod(path_of(key, ".olod"), hierarchy, report); });
}

void BuildCache::store(const std::string& key, const hlod::Hlod& hlod, const MeshReport& report) const {
  store_by("the HLOD",
           [&] { write_ohlod(path_of(key, ".ohlod"), hlod, report, {.compression = OlodCompression::none}); });
}

using SharedHlod = std::shared_ptr<const hlod::Hlod>;

std::string describe(const hlod::HlodBuildOptions& options) {
  std::string text = fmt::format("hlod node_triangles={} nested={} free={} splits={}", options.node_triangles,
                                 options.grouping == hlod::Grouping::nested, options.borders == hlod::Borders::free,
                                 options.within == hlod::Within::splits);
  if (options.quantise_bits != 0) text += fmt::format(" quantise_bits={}", options.quantise_bits);
  return text;
}

SharedHlod build(const SceneDescription& scene, const std::filesystem::path& folder, const LoadOptions& options) {
  std::optional<BuildCache> cache;
  std::string key;
  if (options.use_cache) {
    cache.emplace(user_cache_folder(), options.note);
    key = cache_key_of_scene(scene, folder, describe(options.build_hlod));
    if (auto found = cache->find_hlod(key)) return std::make_shared<const hlod::Hlod>(*std::move(found));
  }
  const CleanMesh input = flatten_scene(scene, folder, options.progress);
  hlod::HlodBuildOptions build = options.build_hlod;
  build.progress = [&](double done) {
    if (options.progress) options.progress("building " + (scene.name.empty() ? "the scene" : scene.name), done);
    return !options.build_hlod.progress || options.build_hlod.progress(done);
  };
  auto hlod = std::make_shared<const hlod::Hlod>(build_hlod(input.mesh, build));
  if (cache) cache->store(key, *hlod, input.report);
  return hlod;
}

// Tells `progress` of the meshes, which are decompressed and checked here.
SharedHlod read(const std::string& file, const std::optional<hlod::CacheOptions>& paged,
                const std::function<void(const std::string&, double)>& progress) {
  if (paged) return std::make_shared<const hlod::Hlod>(open_ohlod(file, *paged).hlod);
  auto hlod = std::make_shared<const hlod::Hlod>(read_ohlod(file).hlod);
  const auto count = static_cast<hlod::NodeId>(hlod->node_count());
  const hlod::NodeId hundredth = count / 100 + 1;
  for (hlod::NodeId n = 0; n < count; ++n) {
    if (progress && n % hundredth == 0) progress(file, static_cast<double>(n) / count);
    hlod->require(n);
    hlod->require_within(n);
  }
  return hlod;
}

// Returns a file's share of the budget.
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
                                   const LoadOptions& options) {
  SceneDescription meshes = scene;  // without .ohlod files
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
    if (!shared) shared = read(name, paged, options.progress);
    hlods.push_back(
        {shared, positions_to_world(object.object_to_world, shared->data().origin), object.two_sided, name});
  }
  if (meshes.objects.empty()) return hlods;
  const bool two_sided = std::any_of(meshes.objects.begin(), meshes.objects.end(),
                                     [](const SceneObject& object) { return object.two_sided; });
  const SharedHlod all = build(meshes, folder, options);
  hlods.insert(hlods.begin(), {all, positions_to_world(glm::dmat4(1.0), all->data().origin), two_sided, scene.name});
  return hlods;
}

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
    result.two_sided = object.two_sided;
    result.attributes = object.attributes;
    result.source_name = name_of_source(object.source, scene, index, folder_);
    SharedHierarchy& shared = loaded_[result.source_name];
    if (!shared)
      shared = std::visit([&](const auto& source) { return load_source(source, result.source_name); }, object.source);
    result.hierarchy = shared;
    result.object_to_world = positions_to_world(object.object_to_world, shared->data().origin);
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
