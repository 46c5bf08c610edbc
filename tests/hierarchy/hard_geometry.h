// What holds for every mesh, however hard.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "hierarchy/hierarchy_bytes.h"
#include "occlod/build_hierarchy.h"

namespace occlod::test {

// Builds, down to `base_triangles`, the same bytes again and with other threads; every invariant holds, random cuts
// conform, and all splits applied are the input.
[[nodiscard]] inline Hierarchy build_soundly(const TriangleMesh& mesh, std::size_t base_triangles = 0) {
  BuildOptions options;
  options.base_triangles = base_triangles;
  options.threads = 1;
  Hierarchy hierarchy = build_hierarchy(mesh, options);
  EXPECT_TRUE(same_bytes(hierarchy, build_hierarchy(mesh, options)));
  options.threads = 3;
  EXPECT_TRUE(same_bytes(hierarchy, build_hierarchy(mesh, options)));
  const std::vector<std::string> violations = validate(hierarchy);
  EXPECT_TRUE(violations.empty()) << violations[0];
  EXPECT_TRUE(restores(hierarchy, mesh));
  EXPECT_LE(hierarchy.base_triangle_count(), base_triangles);
  EXPECT_TRUE(std::isfinite(hierarchy.error_bound()));
  return hierarchy;
}

// Vertices - edges + faces.
[[nodiscard]] inline long euler_characteristic(const TriangleMesh& mesh) {
  std::vector<std::array<VertexId, 2>> edges;
  for (const Triangle& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) edges.push_back({std::min(t[i], t[(i + 1) % 3]), std::max(t[i], t[(i + 1) % 3])});
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return static_cast<long>(mesh.vertex_count()) - static_cast<long>(edges.size()) +
         static_cast<long>(mesh.triangle_count());
}

}  // namespace occlod::test
