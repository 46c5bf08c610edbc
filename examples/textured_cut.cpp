// Simplifies a mesh with a texture and two materials. Its seam and the borders between the materials stay where they
// are. Writes textured_cut.glb, which holds the texture, and a picture of it, textured_cut.png.
#include <cmath>
#include <exception>
#include <glm/gtc/constants.hpp>
#include <iostream>

#include "occlod/occlod.h"
#include "occlod/picture.h"

namespace {

// Makes a planet with texture coordinates by longitude and latitude, and seas of another material. Every corner of a
// triangle gets a vertex of its own: clean() joins those that are equal.
occlod::TriangleMesh textured_planet() {
  const occlod::TriangleMesh planet = occlod::generate("rough-planet", {{"level", 7}});
  occlod::TriangleMesh mesh;
  for (const occlod::Triangle& triangle : planet.triangles) {
    float first_u = 0.0F, height = 0.0F;
    for (int corner = 0; corner < 3; ++corner) {
      const glm::vec3& p = planet.positions[triangle[corner]];
      float u = std::atan2(p.x, p.z) / glm::two_pi<float>();
      if (corner == 0) first_u = u;
      u += std::round(first_u - u);  // triangles across the seam are not torn
      mesh.positions.push_back(p);
      mesh.texture_coordinates.emplace_back(u, std::asin(p.y / glm::length(p)) / glm::pi<float>() + 0.5F);
      height += glm::length(p) / 3.0F;
    }
    const auto end = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.triangles.emplace_back(end - 3, end - 2, end - 1);
    mesh.triangle_materials.push_back(height < 0.985F ? 1 : 0);
  }
  mesh.materials = {{.name = "land", .texture = 0}, {.name = "sea", .base_color = {0.02F, 0.1F, 0.4F, 1.0F}}};
  mesh.textures = {{.file = "checker.png", .mime_type = {}, .bytes = {}}};
  return occlod::clean(std::move(mesh), {}, "planet").mesh;
}

}  // namespace

int main() try {
  occlod::write_png("checker.png", occlod::checker_image(16, 64));
  const occlod::Hierarchy planet = occlod::build_hierarchy(textured_planet());
  const occlod::FixedCut cut = occlod::cut_to_triangles(planet, 6'000);
  occlod::write_mesh("textured_cut.glb", occlod::cut_mesh(planet, cut));
  std::cout << cut.triangles << " of " << planet.input_triangle_count() << " triangles, no farther than "
            << cut.guaranteed_error << " from the input\n";

  const std::vector<occlod::Triangle> triangles = occlod::wedge_triangles_of(planet, cut);
  const occlod::DrawObject drawn[] = {{.positions = planet.positions(), .triangles = triangles}};
  const occlod::TextureImage image(occlod::checker_image(16, 64));
  const occlod::DrawMaterial materials[] = {{.image = &image}, {.base_color = {0.02F, 0.1F, 0.4F}}};
  const occlod::ObjectTexture look[] = {{planet.data().texture_coordinates, planet.data().wedge_materials, materials}};
  const occlod::View view(occlod::Camera{.eye = {0.0, 0.8, -2.8}});
  occlod::ItemBuffer items;
  occlod::draw_items(items, drawn, view);
  occlod::write_png("textured_cut.png", occlod::shade(items, drawn, view, {.wire = false, .textures = look}));
} catch (const std::exception& error) {
  std::cerr << "textured_cut: " << error.what() << '\n';
  return 1;
}
