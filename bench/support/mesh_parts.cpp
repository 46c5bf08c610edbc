#include "support/mesh_parts.h"

#include <numeric>

#include "cells/cell_geometry.h"

namespace occlod::bench {

MeshParts parts_of(const TriangleMesh& mesh) {
  std::vector<VertexId> roots(mesh.vertex_count());
  std::iota(roots.begin(), roots.end(), 0U);
  const auto root_of = [&](VertexId v) {
    while (roots[v] != v) v = roots[v] = roots[roots[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles) {
    roots[root_of(t.y)] = root_of(t.x);
    roots[root_of(t.z)] = root_of(t.x);
  }
  std::vector<std::uint32_t> numbers(mesh.vertex_count(), no_id);  // of parts, by root
  MeshParts parts;
  for (const Triangle& t : mesh.triangles) {
    std::uint32_t& number = numbers[root_of(t.x)];
    const glm::dvec3 first(mesh.positions[t.x]);
    if (number == no_id) {
      number = static_cast<std::uint32_t>(parts.boxes.size());
      parts.triangles.push_back(0);
      parts.boxes.push_back({first, first});
    }
    parts.of_triangle.push_back(number);
    ++parts.triangles[number];
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 p(mesh.positions[t[k]]);
      parts.boxes[number] = unite(parts.boxes[number], {p, p});
    }
  }
  return parts;
}

}  // namespace occlod::bench
