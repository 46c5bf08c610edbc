// Measures how far a simplified group is from what it was made from.
#pragma once

#include "occlod/mesh.h"
#include "splits/simplify_group.h"

namespace occlod {

// Returns a bound on the distance between every point of `mesh` and what simplify_group() left of it, and back, in
// object units: at most a tenth above the largest distance, or little above it where faces are hard to measure, and
// never above SimplifiedGroup::guaranteed_error, of which it is at least 1/64. A component of which no face is left
// counts with its extent. Deterministic; about O(n log n).
[[nodiscard]] float measured_error(const TriangleMesh& mesh, const SimplifiedGroup& simplified);

}  // namespace occlod
