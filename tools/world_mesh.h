// The refined objects of a scene as one mesh in world space.
#pragma once

#include <filesystem>
#include <vector>

#include "occlod/mesh.h"
#include "occlod/refiner.h"
#include "occlod/scene.h"

namespace occlod::tool {

// As join_meshes() makes it, to be written to `file`. What no triangle uses is left out.
[[nodiscard]] TriangleMesh world_mesh(const std::vector<LoadedObject>& objects, const Refinement& refinement,
                                      const std::filesystem::path& file);

}  // namespace occlod::tool
