// Refines a mesh for one view inside a budget of triangles, with occlusion decided on the CPU.
// hello [MESH]: without a mesh, a rough planet of 131,072 triangles, near its ground. Writes hello.png.
#include <exception>
#include <iostream>

#include "occlod/occlod.h"
#include "occlod/picture.h"

int main(int argc, char** argv) try {
  const occlod::TriangleMesh mesh =
      argc > 1 ? occlod::read_mesh(argv[1]).mesh : occlod::generate("rough-planet", {{"level", 7}});
  const occlod::Hierarchy hierarchy = occlod::build_hierarchy(mesh);

  const occlod::RefineObject objects[] = {{.hierarchy = &hierarchy}};
  occlod::Refiner refiner(objects);
  const auto visibility = occlod::make_software_occlusion();

  const occlod::Camera near_the_ground{.eye = {0.0, 1.15, 0.0}, .target = {0.0, 0.98, -0.4}, .fov_y_deg = 60.0};
  const occlod::View view(argc > 1 ? occlod::looking_at(hierarchy.box()) : near_the_ground);
  const occlod::Refinement& refined = refiner.refine(view, {.budget = 10'000}, *visibility);

  std::cout << refined.stats.triangles << " of " << mesh.triangle_count() << " triangles, "
            << refined.stats.queries_hidden << " of " << refined.stats.queries << " queries hidden\n";
  occlod::write_png("hello.png", occlod::draw_picture(objects, refined, view));
  return refined.stats.triangles <= 10'000 ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << "hello: " << error.what() << '\n';
  return 1;
}
