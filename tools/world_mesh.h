// Joins the refined objects of a scene to one mesh in world space.
#pragma once

#include <filesystem>
#include <vector>

#include "occlod/mesh.h"
#include "occlod/refiner.h"
#include "occlod/scene.h"

namespace occlod::tool {

// Returns what join_meshes() makes, to be written to `file`, without unused parts.
[[nodiscard]] TriangleMesh world_mesh(const std::vector<LoadedObject>& objects, const Refinement& refinement,
                                      const std::filesystem::path& file);

}  // namespace occlod::tool
