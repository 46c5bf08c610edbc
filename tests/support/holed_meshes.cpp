#include "holed_meshes.h"

#include <algorithm>
#include <cmath>

#include "meshes.h"
#include "occlod/mesh.h"

namespace occlod::test {

TriangleMesh sheet_with_windows() {
  constexpr int cells = 48;
  TriangleMesh mesh = grid(cells, cells);
  for (glm::vec3& p : mesh.positions)
    p = {2.0F * p.x - 1.0F, 2.0F * p.y - 1.0F, 0.03F * std::sin(7.0F * p.x) * std::cos(9.0F * p.y)};
  const auto is_gone = [](float x) { return static_cast<int>(std::floor((x + 1.0F) * (cells / 2))) % 8 == 3; };
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const glm::vec3 middle = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0F;
    return is_gone(middle.x) && is_gone(middle.y);
  });
  return clean(std::move(mesh), {}, "test").mesh;
}

TriangleMesh block(bool tunnels) {
  constexpr int cells = 40, layers = 4;
  constexpr float depth = 0.1F;
  TriangleMesh mesh;
  const auto is_solid = [&](int i, int j, int k) {
    if (std::min({i, j, k}) < 0 || std::max(i, j) >= cells || k >= layers) return false;
    if (tunnels) return i % 8 != 3 || j % 8 != 3;
    return i % 5 != 2 || (k > 0 && k < layers - 1);
  };
  const auto vertex = [&](const glm::ivec3& at) {
    const float x = 2.0F * static_cast<float>(at.x) / cells - 1.0F, y = 2.0F * static_cast<float>(at.y) / cells - 1.0F;
    mesh.positions.emplace_back(x, y,
                                depth * static_cast<float>(at.z) / layers + 0.01F * std::sin(3.0F * x + 2.0F * y));
    return static_cast<VertexId>(mesh.positions.size() - 1);
  };
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j)
      for (int k = 0; k < layers; ++k)
        for (int side = 0; side < 6 && is_solid(i, j, k); ++side) {
          const int axis = side / 2, sign = side % 2;
          glm::ivec3 out(0), u(0), v(0), at(i, j, k);
          out[axis] = 2 * sign - 1;
          if (is_solid(i + out.x, j + out.y, k + out.z)) continue;
          at[axis] += sign;
          u[(axis + 2 - sign) % 3] = v[(axis + 1 + sign) % 3] = 1;
          const VertexId a = vertex(at), b = vertex(at + u), c = vertex(at + u + v), d = vertex(at + v);
          mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
        }
  return clean(std::move(mesh), {}, "test").mesh;
}

}  // namespace occlod::test
