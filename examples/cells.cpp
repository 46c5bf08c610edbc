// Builds the view cells of a street, and walks through them without the city: for each cell, what to draw for every eye
// in it is in the file. Writes cells.vlod and the last frame, cells.png.
#include <exception>
#include <iostream>

#include "occlod/build_cells.h"
#include "occlod/cell_walker.h"
#include "occlod/occlod.h"
#include "occlod/picture.h"

namespace {

const occlod::Camera first_eye{
    .eye = {233, 270, 1.7}, .target = {473, 270, 12}, .up = {0, 0, 1}, .near = 0.2, .far = 1500};

// Cells of 4 m along 24 m of the street: every eye in them, with the angle and size of that camera, sees the city to
// the pixel.
void build(const std::filesystem::path& path) {
  const occlod::Hierarchy city =
      occlod::build_hierarchy(occlod::generate("city", {{"blocks", 8}, {"facade_cells", 4}}));
  const occlod::RefineObject objects[] = {{.hierarchy = &city}};
  const occlod::CellTreeOptions options{
      .cell = {.eyes = occlod::eye_model(occlod::View(first_eye)), .tolerance_px = 1.0},
      .regions = {{{232.0, 268.0, 1.0}, {256.0, 272.0, 2.5}}},
      .root_cell = 4.0,
      .smallest_cell = 4.0,
  };
  occlod::CellBuild(objects, options).write("cells_of_city.vlod");
  // The file names splits of the hierarchy; a packed one also holds their triangles.
  occlod::pack_cells(*occlod::open_vlod("cells_of_city.vlod", objects), objects, path);
}

}  // namespace

int main() try {
  build("cells.vlod");
  // A viewer leaves `loaders` at 1: a thread reads ahead. Here it is done between frames, so that none is late.
  occlod::CellWalker walker(occlod::open_vlod("cells.vlod"), {.memory = std::size_t{64} << 20U, .loaders = 0});
  occlod::CellLoader loader(walker);
  occlod::Camera camera = first_eye;
  const occlod::WalkedFrame* frame = nullptr;
  for (int i = 0; i <= 120; ++i) {
    camera.eye.x = 233.0 + 22.0 * i / 120.0;
    camera.target.x = camera.eye.x + 240.0;
    frame = &walker.step(camera.eye, 1.0 / 60.0);
    if (frame->changed)  // here a renderer uploads frame->objects
      std::cout << "frame " << i << ": " << frame->drawn_triangles << " triangles for cell " << frame->cell << ", "
                << frame->error_px << " px off at most\n";
    while (loader.begin()) loader.finish();
  }

  const occlod::WalkedObject& city = frame->objects[0];
  const occlod::DrawObject drawn[] = {{.positions = city.positions, .triangles = city.triangles}};
  occlod::ItemBuffer items;
  occlod::draw_items(items, drawn, occlod::View(camera));
  occlod::write_png("cells.png", occlod::shade(items, drawn, occlod::View(camera)));
} catch (const std::exception& error) {
  std::cerr << "cells: " << error.what() << '\n';
  return 1;
}
