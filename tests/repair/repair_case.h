// What holds after every repair.
#pragma once

#include <gtest/gtest.h>

#include "occlod/mesh.h"
#include "repair/repair.h"

namespace occlod::repair {

inline MeshReport topology_of(const TriangleMesh& mesh) {
  MeshReport report;
  count_topology(mesh, report);
  return report;
}

// Repairs, and expects a manifold in one direction of which every missing and every added triangle is counted.
inline RepairedMesh repair_soundly(const TriangleMesh& mesh, const RepairOptions& options = {}) {
  RepairedMesh repaired = repair_mesh(mesh, options);
  const RepairCounts& changes = repaired.changes;
  EXPECT_EQ(repaired.mesh.triangle_count(), mesh.triangle_count() - changes.dropped() + changes.triangles_added);
  const MeshReport topology = topology_of(repaired.mesh);
  EXPECT_EQ(topology.nonmanifold_edges, 0U);
  EXPECT_EQ(topology.nonmanifold_vertices, 0U);
  EXPECT_EQ(topology.inconsistent_edges, 0U);
  EXPECT_EQ(topology.repeated_triangles, 0U);
  return repaired;
}

}  // namespace occlod::repair
