// Refines a mesh for one view inside a budget of triangles, with occlusion decided on the CPU.
// hello [MESH]: without a mesh, a rough planet of 131,072 triangles.
#include <exception>
#include <iostream>

#include "occlod/occlod.h"

int main(int argc, char** argv) try {
  const occlod::TriangleMesh mesh =
      argc > 1 ? occlod::read_mesh(argv[1]).mesh : occlod::generate("rough-planet", {{"level", 7}});
  const occlod::Hierarchy hierarchy = occlod::build_hierarchy(mesh);

  const occlod::RefineObject objects[] = {{.hierarchy = &hierarchy}};
  occlod::Refiner refiner(objects);
  const auto visibility = occlod::make_software_occlusion();

  occlod::Camera camera;
  camera.eye = {0.0, 1.2, 0.0};
  camera.target = {0.0, 1.0, -0.8};
  const occlod::Refinement& refined = refiner.refine(occlod::View(camera), {.budget = 10'000}, *visibility);

  std::cout << refined.stats.triangles << " of " << mesh.triangle_count() << " triangles, "
            << refined.stats.queries_hidden << " of " << refined.stats.queries << " queries hidden\n";
  return refined.stats.triangles <= 10'000 ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << "hello: " << error.what() << '\n';
  return 1;
}
