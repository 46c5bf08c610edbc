#include <occlod/base.h>
#include <occlod/build_hierarchy.h>
#include <occlod/generate.h>

#include <cstdio>

int main() {
  const occlod::TriangleMesh mesh = occlod::generate("rough-planet", {{"level", 3}});
  const occlod::Hierarchy hierarchy = occlod::build_hierarchy(mesh);
  std::printf("occlod %s: %zu triangles\n", occlod::version(), mesh.triangle_count());
  return hierarchy.positions().empty() ? 1 : 0;
}
