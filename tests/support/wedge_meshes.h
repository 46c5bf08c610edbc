// Small meshes with seams, and their corners as values that can be compared.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "occlod/mesh.h"

namespace occlod::test {

// What a corner of a triangle has beside its position. Compared bit by bit.
struct CornerAttributes {
  glm::vec3 normal{0.0F, 0.0F, 1.0F};
  glm::u8vec4 color{255};
  glm::vec2 texture{0.0F};
};

// A mesh from triangles of vertices and what their corners have: equal corners of a vertex in one material become one
// wedge, the first of them its first. `materials`: by triangle, or empty for none.
[[nodiscard]] TriangleMesh with_wedges(std::vector<glm::vec3> positions, std::vector<Triangle> triangles,
                                       const std::vector<std::array<CornerAttributes, 3>>& corners,
                                       std::vector<MaterialId> materials = {});

// Position and attributes of the three corners, by their bits, the smallest corner first; and the material.
using CornerKey = std::array<std::uint32_t, 9>;
struct TriangleCorners {
  std::array<CornerKey, 3> corners;
  MaterialId material;
  friend bool operator==(const TriangleCorners&, const TriangleCorners&) = default;
  friend bool operator<(const TriangleCorners& a, const TriangleCorners& b) {
    return a.material != b.material ? a.material < b.material : a.corners < b.corners;
  }
};
// Of all triangles, sorted.
[[nodiscard]] std::vector<TriangleCorners> sorted_corners_of(const TriangleMesh& mesh);

// A triangle soup with corners from few values, so that seams, charts and materials begin and end anywhere. The same
// for the same seed.
[[nodiscard]] TriangleMesh random_soup_with_wedges(std::uint64_t seed);

// The side of a cylinder, open at both ends, with a texture around it once: one seam from end to end.
[[nodiscard]] TriangleMesh cylinder_with_seam(int around, int along);

// A closed cube, each side a grid of n x n squares with its own normal and its own chart.
[[nodiscard]] TriangleMesh cube_of_charts(int n);

// A flat square grid of n x n squares in the unit square, texture coordinates being positions. `chart_of(i, j)` numbers
// the chart of a square: charts lie apart in texture space, by 2 each. `material_of(i, j)`: likewise.
template <typename ChartOf, typename MaterialOf>
[[nodiscard]] TriangleMesh grid_of_charts(int n, const ChartOf& chart_of, const MaterialOf& material_of) {
  std::vector<glm::vec3> positions;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      positions.emplace_back(static_cast<float>(i) / static_cast<float>(n),
                             static_cast<float>(j) / static_cast<float>(n), 0.0F);
  std::vector<Triangle> triangles;
  std::vector<std::array<CornerAttributes, 3>> corners;
  std::vector<MaterialId> materials;
  const auto add = [&](const Triangle& t, int i, int j) {
    triangles.push_back(t);
    materials.push_back(static_cast<MaterialId>(material_of(i, j)));
    std::array<CornerAttributes, 3> attributes;
    for (int k = 0; k < 3; ++k)
      attributes[static_cast<std::size_t>(k)].texture =
          glm::vec2(positions[t[k]]) + glm::vec2(2.0F * static_cast<float>(chart_of(i, j)), 0.0F);
    corners.push_back(attributes);
  };
  const auto at = [&](int i, int j) { return static_cast<VertexId>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      add({at(i, j), at(i + 1, j), at(i + 1, j + 1)}, i, j);
      add({at(i, j), at(i + 1, j + 1), at(i, j + 1)}, i, j);
    }
  return with_wedges(std::move(positions), std::move(triangles), corners, std::move(materials));
}

}  // namespace occlod::test
