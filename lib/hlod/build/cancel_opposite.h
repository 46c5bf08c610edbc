// Removes triangles that cover each other with opposite faces.
#pragma once

#include <cstdint>
#include <vector>

#include "occlod/mesh/triangle_mesh.h"

namespace occlod::hlod {

// Neighbouring nodes may have folded their surfaces onto each other: of each set of triangles with the same corners,
// pairs of opposite winding go, so the oriented boundary stays what it is. The rest keeps its order. Ids are below
// 2^21. `corners`: their wedges, which go with them; empty or as many. Expected O(n).
void cancel_opposite(std::vector<Triangle>& triangles, std::vector<Triangle>& corners);
void cancel_opposite(std::vector<Triangle>& triangles);

}  // namespace occlod::hlod
