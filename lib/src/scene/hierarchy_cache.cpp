#include "scene/hierarchy_cache.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <array>
#include <exception>
#include <fstream>
#include <memory>
#include <utility>

#include "occlod/core/error.h"
#include "occlod/core/version.h"
#include "scene/builder_id.h"

namespace occlod {

namespace fs = std::filesystem;

namespace {

class Hasher {
 public:
  Hasher() : state_(XXH3_createState(), &XXH3_freeState) { XXH3_128bits_reset(state_.get()); }
  void add(const void* bytes, std::size_t size) { XXH3_128bits_update(state_.get(), bytes, size); }
  [[nodiscard]] std::string hex() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
  }

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

// First in every hash, so that what follows needs no separator.
void add_builder(Hasher& hasher, const std::string& build_options) {
  const std::string text =
      fmt::format("occlod {} builder {} olod {} {}\n", version(), builder_id, olod_version, build_options);
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
  std::ifstream stream(path, std::ios::binary);
  std::array<char, 1 << 16> block;
  while (stream.read(block.data(), block.size()) || stream.gcount() > 0)
    hasher.add(block.data(), static_cast<std::size_t>(stream.gcount()));
  if (!stream.eof()) throw Error({path.string(), "", "cannot be read", "check its permissions"});
  return hasher.hex();
}

HierarchyCache::HierarchyCache(fs::path folder, std::function<void(const std::string&)> note)
    : folder_(std::move(folder)), note_(std::move(note)) {
  if (!note_) note_ = [](const std::string&) {};
}

// Checks all of the entry, because a block that is found damaged in the middle of a frame cannot be built again there.
// That takes a tenth of a second for 120 MB, the largest hierarchy of the shipped scenes, which takes seconds to build.
std::optional<Hierarchy> HierarchyCache::find(const std::string& key) const {
  const fs::path path = path_of(key);
  std::error_code ignored;
  if (folder_.empty() || !fs::exists(fs::symlink_status(path, ignored))) return std::nullopt;
  try {
    if (!fs::is_regular_file(path, ignored)) throw Error({path.string(), "", "is not a regular file", ""});
    Hierarchy hierarchy = read_olod(path).hierarchy;
    hierarchy.require_all();
    return hierarchy;
  } catch (const Error& error) {
    const auto& [file, place, problem, remedy] = error.diagnosis();
    note_(
        fmt::format("a cached hierarchy is built again: {}: {}{}{}", file, place, place.empty() ? "" : ": ", problem));
  }
  // Makes room for the new entry: a folder cannot be replaced, and the permissions of a file would be kept.
  fs::remove(path, ignored);
  return std::nullopt;
}

void HierarchyCache::store(const std::string& key, const Hierarchy& hierarchy, const MeshReport& report) const {
  if (folder_.empty()) return note_("neither XDG_CACHE_HOME nor HOME names a folder: nothing is cached");
  try {
    fs::create_directories(folder_);
    write_olod(path_of(key), hierarchy, report);
  } catch (const std::exception& error) {
    note_(fmt::format("the hierarchy is not cached: {}", error.what()));
  }
}

}  // namespace occlod
