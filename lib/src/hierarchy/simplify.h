// Half-edge collapses from the input mesh down to the base mesh, cheapest first, recorded.
#pragma once

#include <cstdint>
#include <vector>

#include "core/large_vector.h"
#include "occlod/core/ids.h"
#include "occlod/hierarchy/build.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

using CollapseId = std::uint32_t;  // names a collapse: its place in the sequence

// v was merged into u.
struct Collapse {
  VertexId v = no_id;
  VertexId u = no_id;
  CollapseId id = no_id;
  std::size_t first_ended = 0;    // into CollapseSequence::ended
  float error = 0.0F;             // quadric error, object units
  float guaranteed_error = 0.0F;  // distance of the faces made from the input, object units
  float moved = 0.0F;  // bound on the distance between what the collapse ended and what it made, object units
};

// One face of one level: its corners, and the collapse that made it; no_id for faces of the input.
struct LevelFace {
  Triangle corners;
  CollapseId made_by = no_id;
};

struct CollapseSequence {
  LargeVector<Collapse> collapses;  // in order; then a sentinel that ends the last one's range
  // The faces that each collapse ended: first the star of v, each face with v as its first corner; in ring order when
  // the star was one closed fan, so face j is (v, r_j, r_j+1) and the last one ends with r_0. Then faces without v,
  // which others were folded onto.
  LargeVector<LevelFace> ended;
  std::vector<LevelFace> base;  // those that are left
};

// `mesh` has passed build_hierarchy's checks. Quick when its vertices are in spatial order. The result does not depend
// on the number of threads.
[[nodiscard]] CollapseSequence simplify(const TriangleMesh& mesh, const BuildOptions& options);

}  // namespace occlod
