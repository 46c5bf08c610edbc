#include "scene/find_mesh.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "occlod/scene.h"

namespace occlod {
namespace {

// The XDG specification says that relative paths in these variables are ignored.
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

namespace {

std::vector<std::filesystem::path> folders_from_environment() {
  const char* variable = std::getenv("OCCLOD_MESHES");
  std::string_view rest = variable == nullptr ? "" : variable;
  std::vector<std::filesystem::path> folders;
  while (!rest.empty()) {
    const std::string_view folder = rest.substr(0, rest.find(':'));
    if (!folder.empty()) folders.emplace_back(folder);
    rest.remove_prefix(std::min(rest.size(), folder.size() + 1));
  }
  return folders;
}

}  // namespace

std::vector<std::filesystem::path> mesh_folders(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> folders = folders_from_environment();
  folders.insert(folders.begin(), folder);
  if (const std::filesystem::path own = user_mesh_folder(); !own.empty()) folders.push_back(own);
  return folders;
}

std::filesystem::path find_mesh(const std::string& name, const std::filesystem::path& folder) {
  for (const std::filesystem::path& start : mesh_folders(folder)) {
    std::error_code ignored;  // folders that cannot be read are skipped
    const std::filesystem::path candidate = start / name;
    if (std::filesystem::is_regular_file(candidate, ignored)) return candidate;
  }
  return {};
}

}  // namespace occlod
