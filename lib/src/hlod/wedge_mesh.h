// The input of an HLOD, and the wedges that its levels add to it.
#pragma once

#include <glm/vec3.hpp>
#include <type_traits>
#include <utility>
#include <vector>

#include "hierarchy/attribute_state.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod::hlod {

// Vertices stay; wedges are added where a collapse stretches a chart over a vertex that had none in it.
class WedgeMesh {
 public:
  explicit WedgeMesh(TriangleMesh mesh) : mesh_(std::move(mesh)), materials_(wedge_materials(mesh_)) {}

  // Its extra wedges are in no order.
  [[nodiscard]] const TriangleMesh& mesh() const noexcept { return mesh_; }
  // By wedge; empty when triangles name none.
  [[nodiscard]] const std::vector<MaterialId>& materials() const noexcept { return materials_; }
  // Whether a vertex may have several wedges.
  [[nodiscard]] bool has_seams() const noexcept { return !mesh_.extra_wedges.empty(); }

  // A wedge of `vertex` with the attributes and the material of `like`. Returns its number.
  WedgeId add(VertexId vertex, WedgeId like) {
    const auto wedge = static_cast<WedgeId>(mesh_.wedge_count());
    mesh_.positions.push_back(glm::vec3(mesh_.positions[vertex]));
    mesh_.extra_wedges.push_back(vertex);
    const auto repeat = [&](auto& values) {
      if (!values.empty()) values.push_back(typename std::decay_t<decltype(values)>::value_type(values[like]));
    };
    repeat(mesh_.normals);
    repeat(mesh_.colors);
    repeat(mesh_.texture_coordinates);
    repeat(materials_);
    return wedge;
  }

 private:
  TriangleMesh mesh_;
  std::vector<MaterialId> materials_;
};

}  // namespace occlod::hlod
