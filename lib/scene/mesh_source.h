// Opens the sources of a scene's meshes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "occlod/mesh.h"
#include "occlod/scene.h"

namespace occlod {

// Returns the path of the file, or the generator with its options: shown to users, and equal for equal meshes. `index`
// is the object whose source it is; `folder` is where relative names start. Throws Error for a file that is not found.
[[nodiscard]] std::string name_of_source(const MeshSource& source, const SceneDescription& scene, std::size_t index,
                                         const std::filesystem::path& folder);

// Returns whether the extension is .olod, ignoring case.
[[nodiscard]] bool is_olod_file(const std::filesystem::path& path);

// Returns whether the extension is .ohlod, ignoring case.
[[nodiscard]] bool is_ohlod_file(const std::filesystem::path& path);

// Reads the file, which must not be an .olod file, or generates the mesh. `name` is name_of_source(); `progress` may be
// empty. Throws Error, also for an .ohlod file, whose nodes are no longer one mesh.
[[nodiscard]] CleanMesh read_source(const MeshSource& source, const std::string& name,
                                    const std::function<void(const std::string& what, double done)>& progress);

}  // namespace occlod
