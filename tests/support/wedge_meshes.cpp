#include "support/wedge_meshes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <random>
#include <utility>

namespace occlod::test {
namespace {

CornerKey key_of(const glm::vec3& p, const CornerAttributes& a) {
  std::uint32_t color = 0;
  std::memcpy(&color, &a.color, sizeof color);
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  return {bits(p.x),        bits(p.y), bits(p.z),         bits(a.normal.x), bits(a.normal.y),
          bits(a.normal.z), color,     bits(a.texture.x), bits(a.texture.y)};
}

}  // namespace

TriangleMesh with_wedges(std::vector<glm::vec3> positions, std::vector<Triangle> triangles,
                         const std::vector<std::array<CornerAttributes, 3>>& corners,
                         std::vector<MaterialId> materials) {
  TriangleMesh mesh;
  mesh.positions = std::move(positions);
  mesh.triangles = std::move(triangles);
  const std::size_t vertices = mesh.positions.size();
  struct Wedge {
    CornerKey key;
    MaterialId material;
    CornerAttributes attributes;
    WedgeId id = no_id;
  };
  std::vector<std::vector<Wedge>> wedges(vertices);
  const auto find = [&](std::size_t t, int k) -> Wedge& {
    const VertexId v = mesh.triangles[t][k];
    const CornerAttributes& a = corners[t][static_cast<std::size_t>(k)];
    const Wedge wanted{key_of(mesh.positions[v], a), materials.empty() ? MaterialId{0} : materials[t], a};
    const auto at = std::find_if(wedges[v].begin(), wedges[v].end(),
                                 [&](const Wedge& w) { return w.key == wanted.key && w.material == wanted.material; });
    return at != wedges[v].end() ? *at : wedges[v].emplace_back(wanted);
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) find(t, k);
  mesh.normals.resize(vertices, {0.0F, 0.0F, 1.0F});
  mesh.colors.resize(vertices, glm::u8vec4(255));
  mesh.texture_coordinates.resize(vertices, glm::vec2(0.0F));
  for (VertexId v = 0; v < vertices; ++v)
    for (std::size_t i = 0; i < wedges[v].size(); ++i) {
      Wedge& w = wedges[v][i];
      w.id = i == 0 ? v : static_cast<WedgeId>(mesh.positions.size());
      if (i > 0) {
        mesh.positions.push_back(glm::vec3(mesh.positions[v]));
        mesh.extra_wedges.push_back(v);
        mesh.normals.emplace_back();
        mesh.colors.emplace_back();
        mesh.texture_coordinates.emplace_back();
      }
      mesh.normals[w.id] = w.attributes.normal;
      mesh.colors[w.id] = w.attributes.color;
      mesh.texture_coordinates[w.id] = w.attributes.texture;
    }
  if (!mesh.extra_wedges.empty())
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      mesh.corners.emplace_back(find(t, 0).id, find(t, 1).id, find(t, 2).id);
  if (!materials.empty()) {
    mesh.materials.resize(static_cast<std::size_t>(*std::max_element(materials.begin(), materials.end())) + 1);
    mesh.triangle_materials = std::move(materials);
  }
  return mesh;
}

std::vector<TriangleCorners> sorted_corners_of(const TriangleMesh& mesh) {
  std::vector<TriangleCorners> result;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    TriangleCorners triangle{{}, mesh.material_of(t)};
    for (int k = 0; k < 3; ++k) {
      const WedgeId w = mesh.wedge_triangles()[t][k];
      CornerAttributes a;
      if (!mesh.normals.empty()) a.normal = mesh.normals[w];
      if (!mesh.colors.empty()) a.color = mesh.colors[w];
      if (!mesh.texture_coordinates.empty()) a.texture = mesh.texture_coordinates[w];
      triangle.corners[static_cast<std::size_t>(k)] = key_of(mesh.positions[mesh.triangles[t][k]], a);
    }
    std::rotate(triangle.corners.begin(), std::min_element(triangle.corners.begin(), triangle.corners.end()),
                triangle.corners.end());
    result.push_back(triangle);
  }
  std::sort(result.begin(), result.end());
  return result;
}

TriangleMesh random_soup_with_wedges(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto below = [&](std::uint64_t n) { return random() % n; };
  const auto unit = [&] { return static_cast<float>(below(1001)) / 1000.0F; };
  const std::size_t vertices = 4 + below(28), faces = 4 + below(80);
  const std::uint64_t values = 1 + below(6), materials = 1 + below(3);
  std::vector<glm::vec3> positions;
  for (std::size_t v = 0; v < vertices; ++v) positions.emplace_back(unit(), unit(), unit());
  std::vector<Triangle> triangles;
  std::vector<std::array<CornerAttributes, 3>> corners;
  std::vector<MaterialId> of_triangles;
  while (triangles.size() < faces) {
    // Half of the faces share an edge with one before, a tenth repeat one.
    Triangle t(below(vertices), below(vertices), below(vertices));
    if (!triangles.empty() && below(2) == 0) {
      const Triangle& other = triangles[below(triangles.size())];
      t = below(5) == 0 ? other : Triangle(other.y, other.x, t.z);
    }
    if (t.x == t.y || t.y == t.z || t.z == t.x) continue;
    triangles.push_back(t);
    of_triangles.push_back(static_cast<MaterialId>(below(materials)));
    std::array<CornerAttributes, 3> attributes;
    for (int k = 0; k < 3; ++k) {
      CornerAttributes& a = attributes[static_cast<std::size_t>(k)];
      const auto value = static_cast<float>(below(values));
      a.normal = glm::vec3(0.0F, std::sin(value), std::cos(value));
      a.color = glm::u8vec4(static_cast<std::uint8_t>(below(values)));
      a.texture = {unit(), value};
      if (below(2) == 0) a.texture = glm::vec2(positions[t[k]]);
    }
    corners.push_back(attributes);
  }
  return with_wedges(std::move(positions), std::move(triangles), corners, std::move(of_triangles));
}

TriangleMesh cylinder_with_seam(int around, int along) {
  std::vector<glm::vec3> positions;
  for (int j = 0; j <= along; ++j)
    for (int i = 0; i < around; ++i) {
      const float angle = 2.0F * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(around);
      positions.emplace_back(std::cos(angle), std::sin(angle),
                             4.0F * static_cast<float>(j) / static_cast<float>(along));
    }
  std::vector<Triangle> triangles;
  std::vector<std::array<CornerAttributes, 3>> corners;
  const auto add = [&](std::array<std::pair<int, int>, 3> places) {
    Triangle t;
    std::array<CornerAttributes, 3> attributes;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [i, j] = places[k];
      t[static_cast<int>(k)] = static_cast<VertexId>(j * around + i % around);
      attributes[k].texture = {static_cast<float>(i) / static_cast<float>(around),
                               static_cast<float>(j) / static_cast<float>(along)};
    }
    triangles.push_back(t);
    corners.push_back(attributes);
  };
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      add({{{i, j}, {i + 1, j}, {i + 1, j + 1}}});
      add({{{i, j}, {i + 1, j + 1}, {i, j + 1}}});
    }
  return with_wedges(std::move(positions), std::move(triangles), corners);
}

TriangleMesh cube_of_charts(int n) {
  std::vector<glm::vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<std::array<CornerAttributes, 3>> corners;
  std::map<std::array<int, 3>, VertexId> ids;
  for (int side = 0; side < 6; ++side) {
    const int axis = side % 3;
    const bool is_far = side >= 3;
    const auto place = [&](int i, int j) {
      std::array<int, 3> p{};
      p[static_cast<std::size_t>(axis)] = is_far ? n : 0;
      p[static_cast<std::size_t>((axis + 1) % 3)] = is_far ? i : j;
      p[static_cast<std::size_t>((axis + 2) % 3)] = is_far ? j : i;
      return p;
    };
    glm::vec3 normal(0.0F);
    normal[axis] = is_far ? 1.0F : -1.0F;
    const auto add = [&](std::array<std::pair<int, int>, 3> places) {
      Triangle t;
      std::array<CornerAttributes, 3> attributes;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [i, j] = places[k];
        const auto [at, is_new] = ids.try_emplace(place(i, j), static_cast<VertexId>(positions.size()));
        if (is_new) positions.push_back(glm::vec3(at->first[0], at->first[1], at->first[2]) / static_cast<float>(n));
        t[static_cast<int>(k)] = at->second;
        attributes[k].normal = normal;
        attributes[k].texture =
            glm::vec2(i, j) / static_cast<float>(n) + glm::vec2(2.0F * static_cast<float>(side), 0.0F);
      }
      triangles.push_back(t);
      corners.push_back(attributes);
    };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        add({{{i, j}, {i + 1, j}, {i + 1, j + 1}}});
        add({{{i, j}, {i + 1, j + 1}, {i, j + 1}}});
      }
  }
  return with_wedges(std::move(positions), std::move(triangles), corners);
}

}  // namespace occlod::test
