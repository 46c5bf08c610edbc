#include <algorithm>
#include <vector>

#include "splits/corner_key.h"
#include "occlod/hierarchy/cut_mesh.h"
#include "occlod/hierarchy/validate.h"

namespace occlod {
namespace {

template <typename Key>
bool are_same(std::vector<Key> a, std::vector<Key> b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  return a == b;
}

bool restores_positions(const Hierarchy& hierarchy, const TriangleMesh& mesh) {
  std::vector<TriangleKey> restored, input;
  restored.reserve(mesh.triangle_count());
  input.reserve(mesh.triangle_count());
  for (const Triangle& t : triangles_of(hierarchy, full_cut(hierarchy)))
    restored.push_back(key_of(t, hierarchy.positions()));
  for (const Triangle& t : mesh.triangles) input.push_back(key_of(t, mesh.positions));
  return are_same(std::move(restored), std::move(input));
}

// Of those attributes that the mesh has.
bool restores_corners(const Hierarchy& hierarchy, const TriangleMesh& mesh) {
  const HierarchyView& view = hierarchy.data();
  const CornerAttributes input{mesh.positions, mesh.normals, mesh.colors, mesh.texture_coordinates};
  CornerAttributes restored{view.positions, view.normals, view.colors, view.texture_coordinates};
  if (!keep_those_of(input, restored)) return false;
  std::vector<CornerKey> of_mesh, of_hierarchy;
  of_mesh.reserve(mesh.triangle_count());
  of_hierarchy.reserve(mesh.triangle_count());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    of_mesh.push_back(corners_of(mesh.wedge_triangles()[t], input, mesh.material_of(t)));
  for (const Triangle& t : wedge_triangles_of(hierarchy, full_cut(hierarchy)))
    of_hierarchy.push_back(corners_of(t, restored, hierarchy.material_of(t.x)));
  return are_same(std::move(of_hierarchy), std::move(of_mesh));
}

}  // namespace

bool restores(const Hierarchy& hierarchy, const TriangleMesh& mesh) {
  if (hierarchy.input_triangle_count() != mesh.triangle_count() || !restores_positions(hierarchy, mesh)) return false;
  const bool has_attributes = !mesh.normals.empty() || !mesh.colors.empty() || !mesh.texture_coordinates.empty() ||
                              !mesh.triangle_materials.empty();
  return !has_attributes || restores_corners(hierarchy, mesh);
}

}  // namespace occlod
