// Where find_mesh() looks.
#pragma once

#include <filesystem>
#include <vector>

namespace occlod {

// In the order of the search: the scene's folder, those of OCCLOD_MESHES, the user's.
[[nodiscard]] std::vector<std::filesystem::path> mesh_folders(const std::filesystem::path& folder);

}  // namespace occlod
