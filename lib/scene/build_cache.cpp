#include "scene/build_cache.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <array>
#include <cstdint>
#include <exception>
#include <fstream>
#include <map>
#include <memory>
#include <utility>

#include "mesh/files_beside.h"
#include "occlod/core/error.h"
#include "occlod/core/version.h"
#include "scene/builder_id.h"
#include "scene/mesh_source.h"

namespace occlod {

namespace fs = std::filesystem;

namespace {

class Hasher {
 public:
  Hasher() : state_(XXH3_createState(), &XXH3_freeState) { XXH3_128bits_reset(state_.get()); }
  void add(const void* bytes, std::size_t size) { XXH3_128bits_update(state_.get(), bytes, size); }
  // And how long it is, so that what follows needs no separator.
  void add_file(const fs::path& path) {
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

// First in every hash, so that what follows needs no separator.
void add_builder(Hasher& hasher, const std::string& build_options) {
  const std::string text = fmt::format("occlod {} builder {} olod {} ohlod {} {}\n", version(), builder_id,
                                       olod_version, ohlod_version, build_options);
  hasher.add(text.data(), text.size());
}

}  // namespace

std::string cache_key_of_text(const std::string& text, const std::string& build_options) {
  Hasher hasher;
  add_builder(hasher, build_options);
  hasher.add(text.data(), text.size());
  return hasher.hex();
}

std::string cache_key_of_file(const fs::path& path, const std::string& build_options) {
  Hasher hasher;
  add_builder(hasher, build_options + path.extension().string());
  hasher.add_file(path);
  for (const fs::path& beside : files_beside(path)) hasher.add_file(beside);
  return hasher.hex();
}

std::string cache_key_of_scene(const SceneDescription& scene, const fs::path& folder,
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

// Checks all of the entry, because a block that is found damaged in the middle of a frame cannot be built again there.
// That takes a tenth of a second for 120 MB, the largest hierarchy of the shipped scenes, which takes seconds to build.
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
  // Makes room for the new entry: a folder cannot be replaced, and the permissions of a file would be kept.
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
  store_by("the HLOD", [&] { write_ohlod(path_of(key, ".ohlod"), hlod, report, OlodCompression::none); });
}

}  // namespace occlod
