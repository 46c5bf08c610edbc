// Hierarchies and HLODs that have been built before, in the user's cache folder.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "occlod/io/ohlod.h"
#include "occlod/io/olod.h"
#include "occlod/scene/scene.h"

namespace occlod {

// Throws nothing but std::bad_alloc: a cache that cannot be used is reported to `note` and does nothing.
class BuildCache {
 public:
  BuildCache(std::filesystem::path folder, std::function<void(const std::string&)> note);

  // Every part of what they return has been checked. An entry that fails is reported to `note` and removed.
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

// 32 hexadecimal digits that change whenever what is built might: the bytes of the input (the content of a file and of
// those that it names, or a generator's options), the build options, the versions of the formats and of the sources of
// the builders. Throws Error when the file cannot be read.
[[nodiscard]] std::string cache_key_of_file(const std::filesystem::path& path, const std::string& build_options);
[[nodiscard]] std::string cache_key_of_text(const std::string& text, const std::string& build_options);
// The same for all objects of a scene together and where they are. Throws Error also for a mesh that is nowhere.
[[nodiscard]] std::string cache_key_of_scene(const SceneDescription& scene, const std::filesystem::path& folder,
                                             const std::string& build_options);

}  // namespace occlod
