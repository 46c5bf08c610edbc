// How far any cut is from the input: the other half of the guaranteed error.
#pragma once

#include <span>
#include <vector>

#include "splits/level_faces.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// For each collapse a bound on the distance of every point of the faces that it made from the input: that of the faces
// that it ended and its own movement together, or where that is much more than `wanted` what is measured against a
// finer mesh of the sequence.
[[nodiscard]] std::vector<float> backward_errors(const TriangleMesh& mesh, const LevelFaces& levels,
                                                 std::span<const float> wanted);

}  // namespace occlod
