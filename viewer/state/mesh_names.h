// Names meshes in scene files.
#pragma once

#include <filesystem>
#include <string>

namespace occlod::viewer {

// Returns the name by which find_mesh() finds `mesh` for a scene file in `folder`. It is the first of these that works:
// its path below the folder; its name, or the end of its path, in the mesh folders; its path below the folder's parent,
// like "../meshes/statue.ply"; its absolute path. So scenes can be moved with their meshes, or to another machine.
[[nodiscard]] std::string name_in_scene(const std::filesystem::path& mesh, const std::filesystem::path& folder);

}  // namespace occlod::viewer
