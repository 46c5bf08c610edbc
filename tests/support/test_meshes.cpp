#include "support/test_meshes.h"

#include <cstdlib>
#include <sstream>
#include <string>

namespace occlod::test {

std::optional<std::filesystem::path> find_test_mesh(std::string_view name) {
  const char* folders = std::getenv("OCCLOD_MESHES");
  std::istringstream list(folders != nullptr ? folders : "");
  for (std::string folder; std::getline(list, folder, ':');) {
    const std::filesystem::path path = std::filesystem::path(folder) / name;
    if (!folder.empty() && std::filesystem::exists(path)) return path;
  }
  return std::nullopt;
}

}  // namespace occlod::test
