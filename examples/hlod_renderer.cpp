// Draws an HLOD in a renderer of one's own: selects the nodes for a view, and lists the triangles of their meshes.
// Writes hlod_renderer.png with a colour for each level. hlod::Traverser selects without looking at every node, and
// leaves out what is hidden, if the renderer is an hlod::RenderDevice: see opengl.cpp.
#include <exception>
#include <iostream>

#include "occlod/build_hlod.h"
#include "occlod/occlod.h"
#include "occlod/picture.h"

namespace hlod = occlod::hlod;

namespace {

using Draw = std::pair<hlod::NodeId, hlod::Patch>;

// Goes through all nodes, parents first. A node is replaced by its children where its error covers more pixels than
// allowed. Children never have a larger error, so what remains is a whole surface, without gaps.
std::vector<Draw> select_draws(const hlod::Hlod& hlod, const occlod::View& view, double tolerance_px) {
  const occlod::ObjectView object(view, occlod::positions_to_world(glm::dmat4(1.0), hlod.data().origin));
  const hlod::ScreenScale scale = hlod::screen_scale(view, object);
  std::vector<bool> refined(hlod.node_count());
  std::vector<Draw> draws;
  for (hlod::NodeId n = 0; n < hlod.node_count(); ++n) {
    refined[n] = hlod::screen_error_px(hlod.node(n), scale) > tolerance_px;  // never on level 0, whose error is 0
    if (refined[n] || !object.may_be_inside(hlod.node(n).sphere)) continue;
    for (const hlod::Patch& patch : hlod.patches(n))
      if (patch.parent == occlod::no_id || refined[patch.parent]) draws.emplace_back(n, patch);
  }
  return draws;
}

}  // namespace

int main() try {
  const hlod::Hlod city = hlod::build_hlod(occlod::generate("city", {{"blocks", 24}}));
  const occlod::View view({.eye = {20, 20, 60}, .target = {600, 600, 0}, .up = {0, 0, 1}, .height = 512, .far = 4000});
  const std::vector<Draw> draws = select_draws(city, view, 2.0);

  // A renderer uploads the mesh of a node once, and draws ranges of its indices. Here all go into one mesh.
  occlod::TriangleMesh drawn;
  for (const auto& [n, patch] : draws) {
    const hlod::NodeMesh mesh = city.mesh(n);
    const int level = city.node(n).level;  // 0 is the input
    const glm::u8vec4 color(250 - 40 * level, 60 + 190 * (level % 2), 90 + 25 * level, 255);
    const auto first = static_cast<std::uint32_t>(drawn.positions.size());
    drawn.positions.insert(drawn.positions.end(), mesh.positions.begin(), mesh.positions.end());
    drawn.colors.resize(drawn.positions.size(), color);
    for (std::size_t i = patch.first_index; i < patch.first_index + patch.index_count; i += 3)
      drawn.triangles.push_back(first + occlod::Triangle(mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]));
  }
  std::cout << drawn.triangle_count() << " triangles in " << draws.size() << " draws\n";
  const occlod::DrawObject objects[] = {{drawn.positions, drawn.colors, drawn.triangles}};
  occlod::ItemBuffer items;
  occlod::draw_items(items, objects, view);
  occlod::write_png("hlod_renderer.png", occlod::shade(items, objects, view, {.wire = false}));
} catch (const std::exception& error) {
  std::cerr << "hlod_renderer: " << error.what() << '\n';
  return 1;
}
