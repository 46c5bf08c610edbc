#include "mesh/glb_primitives.h"

#include <cstddef>
#include <cstdint>

namespace occlod {

std::vector<GlbPrimitive> glb_primitives(const TriangleMesh& mesh) {
  const std::vector<Triangle>& corners = mesh.wedge_triangles();
  std::vector<GlbPrimitive> primitives;
  if (mesh.triangle_materials.empty()) {
    GlbPrimitive& all = primitives.emplace_back();
    all.wedges.resize(mesh.wedge_count());
    for (WedgeId w = 0; w < all.wedges.size(); ++w) all.wedges[w] = w;
    all.triangles = corners;
    return primitives;
  }
  std::vector<std::vector<std::size_t>> by_material(mesh.materials.size());
  for (std::size_t t = 0; t < corners.size(); ++t) by_material[mesh.triangle_materials[t]].push_back(t);
  std::vector<std::uint32_t> place(mesh.wedge_count());
  std::vector<std::uint32_t> seen_by(mesh.wedge_count(), no_id);
  for (std::size_t m = 0; m < by_material.size(); ++m) {
    if (by_material[m].empty()) continue;
    GlbPrimitive& primitive = primitives.emplace_back();
    primitive.material = static_cast<MaterialId>(m);
    for (const std::size_t t : by_material[m]) {
      Triangle triangle;
      for (int k = 0; k < 3; ++k) {
        const WedgeId w = corners[t][k];
        if (seen_by[w] != m) {
          seen_by[w] = static_cast<std::uint32_t>(m);
          place[w] = static_cast<std::uint32_t>(primitive.wedges.size());
          primitive.wedges.push_back(w);
        }
        triangle[k] = place[w];
      }
      primitive.triangles.push_back(triangle);
    }
  }
  return primitives;
}

}  // namespace occlod
