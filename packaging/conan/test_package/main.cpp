#include <occlod/core/version.h>
#include <occlod/hierarchy/build.h>
#include <occlod/mesh/generate.h>

#include <cstdio>

int main() {
  const occlod::TriangleMesh mesh = occlod::generate_rough_planet({.level = 3});
  const occlod::Hierarchy hierarchy = occlod::build_hierarchy(mesh);
  std::printf("occlod %s: %zu triangles\n", occlod::version(), mesh.triangle_count());
  return hierarchy.positions().empty() ? 1 : 0;
}
