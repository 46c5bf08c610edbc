// Lists the folders in which find_mesh() looks.
#pragma once

#include <filesystem>
#include <vector>

namespace occlod {

// Returns the folders in the order of the search: the scene's folder, those of OCCLOD_MESHES, the user's.
[[nodiscard]] std::vector<std::filesystem::path> mesh_folders(const std::filesystem::path& folder);

// Returns the user's own folders, as the XDG Base Directory Specification defines them.

// Returns ${XDG_CACHE_HOME:-~/.cache}/occlod; empty when neither variable nor HOME is set to an absolute path.
[[nodiscard]] std::filesystem::path user_cache_folder();
// Returns ${XDG_CONFIG_HOME:-~/.config}/occlod; empty when neither that variable nor HOME is set to an absolute path.
[[nodiscard]] std::filesystem::path user_config_folder();
// Returns ${XDG_DATA_HOME:-~/.local/share}/occlod/meshes; empty when neither that variable nor HOME is set to an
// absolute path.
[[nodiscard]] std::filesystem::path user_mesh_folder();

}  // namespace occlod
