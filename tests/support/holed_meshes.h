// Meshes that close when they are simplified, from -1 to 1 along x and y.
#pragma once

#include "occlod/mesh.h"

namespace occlod::test {

// A wavy sheet near z = 0 with 6 x 6 square windows, 1/24 wide.
[[nodiscard]] TriangleMesh sheet_with_windows();

// A block from z = 0 to 0.1 with tunnels right through along z, or with grooves along its top and bottom.
[[nodiscard]] TriangleMesh block(bool tunnels);

}  // namespace occlod::test
