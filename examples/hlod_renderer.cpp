// Draws an HLOD in a renderer of one's own: each frame says which meshes to upload, and which of their triangles to
// draw. Writes the last frame to hlod_renderer.png with a colour for each level.
#include <exception>
#include <iostream>
#include <map>

#include "occlod/build_hlod.h"
#include "occlod/occlod.h"
#include "occlod/picture.h"
#include "occlod/select.h"

namespace hlod = occlod::hlod;

int main() try {
  const hlod::Hlod city = hlod::build_hlod(occlod::generate("city", {{"blocks", 24}}));
  const hlod::PlacedHlod objects[] = {{.hlod = &city}};
  hlod::Selector selector(objects);
  std::map<hlod::NodeId, occlod::TriangleMesh> buffers;  // of a GPU
  occlod::ItemBuffer items;
  for (int i = 0; i <= 60; ++i) {
    const occlod::View view({.eye = {125.0 + 3.5 * i, 481, 90}, .target = {900, 480, 0}, .up = {0, 0, 1}, .far = 4000});
    const hlod::Selection& selection = selector.select(view, {.tolerance_px = 2.0});
    std::vector<occlod::DrawObject> draws;
    for (const auto& [object, node, mesh, ranges] : selection.nodes) {
      const auto [at, is_new] = buffers.try_emplace(node);
      occlod::TriangleMesh& buffer = at->second;
      if (is_new) {                               // upload it
        const int level = city.node(node).level;  // 0 is the input
        buffer.positions.assign(mesh.positions.begin(), mesh.positions.end());
        buffer.colors.assign(mesh.positions.size(), {250 - 40 * level, 60 + 190 * (level % 2), 90 + 25 * level, 255});
        for (std::size_t k = 0; k < mesh.indices.size(); k += 3)
          buffer.triangles.emplace_back(mesh.indices[k], mesh.indices[k + 1], mesh.indices[k + 2]);
      }
      for (const hlod::DrawRange& range : ranges)  // draw it
        draws.push_back({buffer.positions, buffer.colors,
                         std::span(buffer.triangles).subspan(range.first_index / 3, range.index_count / 3)});
    }
    occlod::draw_items(items, draws, view);
    if (i % 20 == 0)
      std::cout << "frame " << i << ": " << selection.triangles << " triangles in " << draws.size() << " draws, "
                << selection.hidden << " nodes hidden, " << buffers.size() << " uploaded\n";
    if (i == 60) occlod::write_png("hlod_renderer.png", occlod::shade(items, draws, view, {.wire = false}));
  }
} catch (const std::exception& error) {
  std::cerr << "hlod_renderer: " << error.what() << '\n';
  return 1;
}
