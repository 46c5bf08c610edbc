// The refined objects of a scene as one mesh in world space.
#pragma once

#include <span>

#include "occlod/mesh/triangle_mesh.h"
#include "occlod/picture/picture.h"

namespace occlod::tool {

// Vertices that no triangle uses are left out; triangles of mirrored objects are turned round, so that outsides stay
// outside. Colours are kept when every object has them.
[[nodiscard]] TriangleMesh world_mesh(std::span<const DrawObject> objects);

}  // namespace occlod::tool
