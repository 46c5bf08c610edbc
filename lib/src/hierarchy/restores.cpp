#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

#include "occlod/hierarchy/cut_mesh.h"
#include "occlod/hierarchy/validate.h"
#include "triangle_key.h"

namespace occlod {
namespace {

// What is to be drawn at the corners of a mesh.
struct Attributes {
  std::span<const glm::vec3> positions, normals;
  std::span<const glm::u8vec4> colors;
  std::span<const glm::vec2> texture_coordinates;
};

// A triangle by its material and the bits at its corners, the smallest corner first, in winding order.
struct CornerKey {
  std::array<std::array<std::uint32_t, 9>, 3> corners{};
  MaterialId material = 0;
  friend bool operator==(const CornerKey&, const CornerKey&) = default;
  friend bool operator<(const CornerKey& a, const CornerKey& b) {
    return a.material != b.material ? a.material < b.material : a.corners < b.corners;
  }
};

CornerKey corners_of(const Triangle& wedges, const Attributes& of, MaterialId material) {
  CornerKey key;
  key.material = material;
  for (std::size_t k = 0; k < 3; ++k) {
    const WedgeId w = wedges[static_cast<int>(k)];
    std::array<std::uint32_t, 9>& corner = key.corners[k];
    for (int i = 0; i < 3; ++i) corner[static_cast<std::size_t>(i)] = bits_of(of.positions[w][i]);
    for (int i = 0; i < 3 && !of.normals.empty(); ++i)
      corner[static_cast<std::size_t>(3 + i)] = bits_of(of.normals[w][i]);
    if (!of.colors.empty()) std::memcpy(&corner[6], &of.colors[w], sizeof(std::uint32_t));
    for (int i = 0; i < 2 && !of.texture_coordinates.empty(); ++i)
      corner[static_cast<std::size_t>(7 + i)] = bits_of(of.texture_coordinates[w][i]);
  }
  std::rotate(key.corners.begin(), std::min_element(key.corners.begin(), key.corners.end()), key.corners.end());
  return key;
}

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
  const auto lacks = [](const auto& restored, const auto& given) { return restored.empty() && !given.empty(); };
  if (lacks(view.normals, mesh.normals) || lacks(view.colors, mesh.colors) ||
      lacks(view.texture_coordinates, mesh.texture_coordinates))
    return false;
  const Attributes input{mesh.positions, mesh.normals, mesh.colors, mesh.texture_coordinates};
  Attributes restored{view.positions, view.normals, view.colors, view.texture_coordinates};
  if (mesh.normals.empty()) restored.normals = {};
  if (mesh.colors.empty()) restored.colors = {};
  if (mesh.texture_coordinates.empty()) restored.texture_coordinates = {};
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
