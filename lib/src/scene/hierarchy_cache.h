// Hierarchies that have been built before, in the user's cache folder.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "occlod/io/olod.h"

namespace occlod {

// Throws nothing but std::bad_alloc: a cache that cannot be used is reported to `note` and does nothing.
class HierarchyCache {
 public:
  HierarchyCache(std::filesystem::path folder, std::function<void(const std::string&)> note);

  // Every part of what it returns has been checked. An entry that fails is reported to `note` and removed.
  [[nodiscard]] std::optional<Hierarchy> find(const std::string& key) const;
  void store(const std::string& key, const Hierarchy& hierarchy, const MeshReport& report) const;

 private:
  [[nodiscard]] std::filesystem::path path_of(const std::string& key) const { return folder_ / (key + ".olod"); }

  std::filesystem::path folder_;
  std::function<void(const std::string&)> note_;
};

// 32 hexadecimal digits that change whenever the hierarchy might: the bytes of the input (a file's content or a
// generator's options), the build options, the version of the format and of the sources of the builder. Throws Error
// when the file cannot be read.
[[nodiscard]] std::string cache_key_of_file(const std::filesystem::path& path, const std::string& build_options);
[[nodiscard]] std::string cache_key_of_text(const std::string& text, const std::string& build_options);

}  // namespace occlod
