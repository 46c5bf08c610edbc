// Where the meshes of a scene come from.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "occlod/mesh.h"
#include "occlod/scene.h"

namespace occlod {

// The file that is found, or the generator with its options: shown to users, and the same for the same mesh. `index`:
// of the object whose source it is; `folder`: where relative names start. Throws Error for a file that is nowhere.
[[nodiscard]] std::string name_of_source(const MeshSource& source, const SceneDescription& scene, std::size_t index,
                                         const std::filesystem::path& folder);

// By its extension, whatever its case.
[[nodiscard]] bool is_olod_file(const std::filesystem::path& path);

// The same of an .ohlod file.
[[nodiscard]] bool is_ohlod_file(const std::filesystem::path& path);

// Gives what the generator makes in pieces; nothing of a file.
void stream_generated(const MeshSource& source, const std::function<void(const TriangleMesh& piece)>& take);

// Reads the file, which is no .olod file, or generates the mesh. `name` is name_of_source(); `progress` may be empty.
// Throws Error, also for an .ohlod file, whose nodes are no longer one mesh.
[[nodiscard]] CleanMesh read_source(const MeshSource& source, const std::string& name,
                                    const std::function<void(const std::string& what, double done)>& progress);

}  // namespace occlod
