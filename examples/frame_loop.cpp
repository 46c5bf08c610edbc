// Walks through a city. Each frame continues from the mesh of the frame before, and hands only what has changed to the
// renderer, whose index buffer is an array here. Writes the last frame to frame_loop.png.
#include <algorithm>
#include <exception>
#include <iostream>
#include <vector>

#include "occlod/occlod.h"
#include "occlod/picture.h"

int main() try {
  const occlod::Hierarchy city =
      occlod::build_hierarchy(occlod::generate("city", {{"blocks", 16}, {"facade_cells", 8}}));
  const occlod::RefineObject objects[] = {{.hierarchy = &city}};
  occlod::Refiner refiner(objects);
  const auto visibility = occlod::make_software_occlusion();

  // The vertex buffer would hold city.positions(), which never change.
  std::vector<occlod::Triangle> index_buffer;
  occlod::Camera camera{
      .up = {0.0, 0.0, 1.0}, .fov_y_deg = 60.0, .width = 960, .height = 540, .near = 0.2, .far = 3000.0};
  for (int frame = 0; frame < 60; ++frame) {
    camera.eye = {125.0 + 3.5 * frame, 481.0, 1.7};
    camera.target = {900.0, 480.0, 14.0};
    const occlod::Refinement& refined = refiner.update(occlod::View(camera), {.budget = 4'000}, *visibility);

    const occlod::RefinedObject& object = refined.objects[0];
    index_buffer.resize(object.triangles.size());
    for (const occlod::TriangleRange& range : object.changes)  // here a renderer uploads part of its index buffer
      std::copy_n(object.triangles.begin() + range.first, range.count, index_buffer.begin() + range.first);
    if (index_buffer != object.triangles) return 1;  // never happens: the changes are complete

    if (frame % 10 == 0)
      std::cout << "frame " << frame << ": " << index_buffer.size() << " triangles, " << refined.stats.changed_triangles
                << " of them uploaded\n";
  }

  const occlod::View view(camera);
  const occlod::DrawObject drawn[] = {{.positions = city.positions(), .triangles = index_buffer}};
  occlod::ItemBuffer items;
  occlod::draw_items(items, drawn, view);
  occlod::write_png("frame_loop.png", occlod::shade(items, drawn, view));
} catch (const std::exception& error) {
  std::cerr << "frame_loop: " << error.what() << '\n';
  return 1;
}
