// Vertices that are nearly at one place.
#pragma once

#include <vector>

#include "occlod/mesh.h"

namespace occlod::repair {

// For each vertex the one that it is merged into, or itself: the nearest of the earlier vertices that are kept, if that
// is within `distance` (> 0, object units; the smaller number where two are as near). So no vertex moves farther than
// `distance`, and those kept are farther apart. Expected O(n).
[[nodiscard]] std::vector<VertexId> weld_targets(const TriangleMesh& mesh, double distance);

}  // namespace occlod::repair
