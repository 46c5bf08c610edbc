// Where the vertices of a node are while it is on its way to its parents, or refined within.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/device.h"
#include "occlod/hlod.h"

namespace occlod::hlod {

// Of the vertices that the ranges use; those of other vertices are as in the mesh. Object space. The meshes of the node
// and of the parents of patches that morph are required first, which may throw Error. The result is the mesh's own
// array or `scratch`. Reuses its memory. O(vertices + indices of ranges that morph).
[[nodiscard]] std::span<const glm::vec3> morphed_positions(const Hlod& hlod, NodeId node,
                                                           std::span<const DrawRange> ranges,
                                                           std::vector<glm::vec3>& scratch);

// For NodeDraw::cut: the positions of the mesh and then those of the splits. Object space, in `scratch`. Both are
// required first, which may throw Error. O(vertices).
[[nodiscard]] std::span<const glm::vec3> cut_positions(const Hlod& hlod, NodeId node, std::vector<glm::vec3>& scratch);

}  // namespace occlod::hlod
