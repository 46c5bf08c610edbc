// Finds vertices that are nearly at one place.
#pragma once

#include <vector>

#include "occlod/mesh.h"

namespace occlod::repair {

// Returns, per vertex, the vertex that it is merged into, or itself: the nearest of the earlier vertices that are kept,
// if it is within `distance` (> 0, object units; ties by number). So no vertex moves farther than `distance`, and kept
// vertices are farther apart. Expected O(n).
[[nodiscard]] std::vector<VertexId> weld_targets(const TriangleMesh& mesh, double distance);

}  // namespace occlod::repair
