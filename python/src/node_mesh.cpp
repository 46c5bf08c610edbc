#include "node_mesh.h"

#include <vector>

namespace occlod::python {
namespace {

struct NodeArrays {
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::u8vec4> colors;
  std::vector<std::uint16_t> indices, merged_into;
  std::vector<glm::vec2> texture_coordinates;
  std::vector<MaterialId> materials;
  std::vector<std::uint8_t> image;
  std::vector<glm::u16vec2> image_coordinates;
};

template <typename T>
void copy(std::span<const T>& view, std::vector<T>& to) {
  to.assign(view.begin(), view.end());
  view = to;
}

// Appends the values of these vertices, if any have them.
template <typename T>
void append(std::vector<T>& to, std::span<const T> values, std::span<const std::uint16_t> vertices) {
  if (values.empty()) return;
  for (const std::uint16_t v : vertices) to.push_back(values[v]);
}

}  // namespace

PythonNodeMesh node_mesh(const hlod::Hlod& hlod, hlod::NodeId node) {
  hlod.require(node);
  PythonNodeMesh result{hlod, hlod.mesh(node), nullptr};
  if (hlod.store() == nullptr) return result;
  const auto copies = std::make_shared<NodeArrays>();
  hlod::NodeMesh& mesh = result.mesh;
  copy(mesh.positions, copies->positions);
  copy(mesh.normals, copies->normals);
  copy(mesh.colors, copies->colors);
  copy(mesh.indices, copies->indices);
  copy(mesh.merged_into, copies->merged_into);
  copy(mesh.texture_coordinates, copies->texture_coordinates);
  copy(mesh.materials, copies->materials);
  copy(mesh.image, copies->image);
  copy(mesh.image_coordinates, copies->image_coordinates);
  result.copies = copies;
  return result;
}

TriangleMesh mesh_like(const hlod::HlodView& data) {
  TriangleMesh mesh;
  mesh.materials.assign(data.materials.begin(), data.materials.end());
  mesh.textures.assign(data.textures.begin(), data.textures.end());
  mesh.texture_origin = data.texture_origin;
  mesh.origin = data.origin;
  mesh.up = data.up;
  return mesh;
}

void append_triangles(TriangleMesh& mesh, const hlod::NodeMesh& node, std::span<const std::uint16_t> indices) {
  std::vector<VertexId> places(node.positions.size(), no_id);
  std::vector<std::uint16_t> used;  // in the order of their places
  const auto first = static_cast<VertexId>(mesh.positions.size());
  const auto place_of = [&](std::uint16_t v) {
    if (places[v] == no_id) {
      places[v] = first + static_cast<VertexId>(used.size());
      used.push_back(v);
    }
    return places[v];
  };
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    const VertexId a = place_of(indices[i]), b = place_of(indices[i + 1]), c = place_of(indices[i + 2]);
    mesh.triangles.emplace_back(a, b, c);
    if (!node.materials.empty()) mesh.triangle_materials.push_back(node.materials[indices[i]]);
  }
  append(mesh.positions, node.positions, used);
  append(mesh.normals, node.normals, used);
  append(mesh.colors, node.colors, used);
  append(mesh.texture_coordinates, node.texture_coordinates, used);
}

}  // namespace occlod::python
