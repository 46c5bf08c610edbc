// Makes a mesh of what is shown, to be written to a file.
#pragma once

#include <filesystem>

#include "occlod/mesh.h"
#include "refine_worker.h"

namespace occlod::viewer {

// Returns the triangles of the frame's first side, which has one, as one mesh in world space, to be written to `file`.
// Vertices that morph are where they will come to rest. Nodes of an HLOD are welded where their vertices have one
// position. Throws Error as join_meshes() and clean() do. O(triangles * log(triangles)).
[[nodiscard]] TriangleMesh shown_mesh(const RefinedFrame& frame, const std::filesystem::path& file);

}  // namespace occlod::viewer
