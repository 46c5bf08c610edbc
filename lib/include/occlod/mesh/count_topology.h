// Counts edges, fans and components of a mesh.
#pragma once

#include "occlod/mesh/mesh_report.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// Counts the topology fields of a mesh with valid indices into `report`. O(n), on all cores.
void count_topology(const TriangleMesh& mesh, MeshReport& report);

}  // namespace occlod
