#include "scene/user_folders.h"

#include <cstdlib>

namespace occlod {
namespace {

// The specification: relative paths in these variables are to be ignored.
std::filesystem::path absolute_from_environment(const char* variable) {
  const char* value = std::getenv(variable);
  std::filesystem::path path = value == nullptr ? "" : value;
  return path.is_absolute() ? path : std::filesystem::path();
}

std::filesystem::path base_folder(const char* variable, const char* below_home) {
  std::filesystem::path folder = absolute_from_environment(variable);
  if (!folder.empty()) return folder;
  const std::filesystem::path home = absolute_from_environment("HOME");
  return home.empty() ? home : home / below_home;
}

}  // namespace

std::filesystem::path user_cache_folder() {
  const std::filesystem::path base = base_folder("XDG_CACHE_HOME", ".cache");
  return base.empty() ? base : base / "occlod";
}

std::filesystem::path user_config_folder() {
  const std::filesystem::path base = base_folder("XDG_CONFIG_HOME", ".config");
  return base.empty() ? base : base / "occlod";
}

std::filesystem::path user_mesh_folder() {
  const std::filesystem::path base = base_folder("XDG_DATA_HOME", ".local/share");
  return base.empty() ? base : base / "occlod" / "meshes";
}

}  // namespace occlod
