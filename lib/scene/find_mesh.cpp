#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "occlod/scene/scene.h"
#include "scene/mesh_folders.h"
#include "scene/user_folders.h"

namespace occlod {
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
