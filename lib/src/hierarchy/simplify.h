// Half-edge collapses from the input mesh down to the base mesh, in the order of their error, recorded.
#pragma once

#include <cstdint>
#include <vector>

#include "occlod/core/ids.h"
#include "occlod/hierarchy/build.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// v was merged into u: ended faces are gone, faces [first_made, next collapse's first_made) came in their place.
struct Collapse {
  VertexId v = no_id;
  VertexId u = no_id;
  std::size_t first_ended = 0;  // into CollapseSequence::ended
  FaceId first_made = 0;
  float error = 0.0F;             // quadric error, object units
  float guaranteed_error = 0.0F;  // distance of the faces made from the input, object units
};

struct CollapseSequence {
  std::vector<Triangle> faces;  // every face there ever was; the input's first, in their order
  std::vector<Collapse>
      collapses;  // in the order in which they were made; then a sentinel that ends the last one's ranges
  std::vector<FaceId> ended;
  std::vector<FaceId> base;  // faces that are left, ascending
};

[[nodiscard]] CollapseSequence simplify(const TriangleMesh& mesh, const BuildOptions& options);

}  // namespace occlod
