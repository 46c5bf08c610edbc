// Moves the vertices of a simplified group to where they fit what it was made from best.
#pragma once

#include <cstdint>
#include <span>

#include "occlod/mesh.h"
#include "splits/collapse_worker.h"
#include "splits/simplify_group.h"
#include "splits/simplify_state.h"

namespace occlod {

// Refers to a group and to how it was simplified.
struct GroupCollapses {
  const TriangleMesh& mesh;
  std::span<const std::uint8_t> locked;  // per vertex, or empty
  const GroupTarget& target;
  std::span<Collapse* const> collapses;     // in order
  std::span<const float> attribute_errors;  // per collapse, object units; empty where attributes do not count
  float torn = 0.0F;                        // BlockRecord::torn
};

// Sets the group's positions and what they change: the error by how much nearer to the planes of its faces each vertex
// is (root mean square), and the bounds by how far it has moved. Vertices that are locked stay, those on borders, and
// on seams unless these are of a texture. `state` is that of the simplification, when all collapses are made. O(n).
void refit_group(const GroupCollapses& group, SimplifyState& state, SimplifiedGroup& result);

}  // namespace occlod
