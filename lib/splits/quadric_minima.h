// Finds where the planes of all faces that went into a vertex are nearest.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/mesh.h"
#include "splits/simplify_state.h"

namespace occlod {

// Returns for each vertex of the input that is `left` the minimum of its quadric, relative to it, in the state's scale;
// 0 for others. Planes that held a boundary have no say in where a vertex fits best: where some are in a quadric, it is
// summed again from the faces of the input and replaced in the state. `target`: per vertex of the input, the one into
// which it was merged. O(n).
[[nodiscard]] std::vector<glm::vec3> quadric_minima(SimplifyState& state, std::span<const VertexId> left,
                                                    std::span<const VertexId> target, std::span<const Triangle> faces);

}  // namespace occlod
