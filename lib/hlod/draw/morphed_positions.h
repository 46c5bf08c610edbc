// Computes the positions of a node's vertices while they morph towards its parents, or when it is refined within.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/device.h"
#include "occlod/hlod.h"

namespace occlod::hlod {

// Returns the positions of the node's vertices in object space: morphed for the vertices that the ranges use, and as in
// the mesh for others. First requires the meshes of the node and of the parents of patches that morph, which may throw
// Error. The result is the mesh's own array or `scratch`, whose memory is reused. O(vertices + indices of ranges that
// morph).
[[nodiscard]] std::span<const glm::vec3> morphed_positions(const Hlod& hlod, NodeId node,
                                                           std::span<const DrawRange> ranges,
                                                           std::vector<glm::vec3>& scratch);

// Returns the positions for NodeDraw::cut, those of the mesh followed by those of the splits, in object space and in
// `scratch`. First requires both, which may throw Error. O(vertices).
[[nodiscard]] std::span<const glm::vec3> cut_positions(const Hlod& hlod, NodeId node, std::vector<glm::vec3>& scratch);

}  // namespace occlod::hlod
