// Writes a mesh as 3D Tiles for CesiumJS and others, on the ground of the Earth: `occlod serve tiles` shows them.
// tiles [MESH [FOLDER]]: without a mesh, a generated city; without a folder, tiles.
#include "occlod/tiles.h"

#include <exception>
#include <iostream>

#include "occlod/build_hlod.h"
#include "occlod/occlod.h"

int main(int argc, char** argv) try {
  const occlod::TriangleMesh mesh =
      argc > 1 ? occlod::read_mesh(argv[1]).mesh : occlod::generate("city", {{"blocks", 8}, {"facade_cells", 4}});
  // Tiles are a tree, so every node has one parent only.
  const occlod::hlod::Hlod hlod = occlod::hlod::build_hlod(mesh, occlod::tiles::build_options());
  occlod::tiles::TilesetOptions options;
  options.origin = {.longitude_deg = 2.2945, .latitude_deg = 48.8584};
  options.replace = true;  // the tiles of an earlier run
  if (argc > 1) options.image_folder = std::filesystem::path(argv[1]).parent_path();
  const occlod::tiles::TilesetCounts written =
      occlod::tiles::write_tileset(argc > 2 ? argv[2] : "tiles", hlod, options);
  std::cout << written.tiles << " tiles with " << written.triangles << " triangles in " << (written.bytes >> 10U)
            << " KiB\n";
  for (const std::string& image : written.images_left_out) std::cerr << "tiles: left out " << image << '\n';
} catch (const std::exception& error) {
  std::cerr << "tiles: " << error.what() << '\n';
  return 1;
}
