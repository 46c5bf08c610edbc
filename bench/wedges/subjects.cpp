#include "wedges/subjects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <tuple>
#include <utility>

#include "occlod/generate.h"
#include "occlod/mesh.h"
#include "support/bench_meshes.h"

namespace occlod::bench {
namespace {

constexpr double two_pi = 6.28318530717958647692;
constexpr std::array<const char*, 3> generated = {"cylinder", "fragmented", "charts"};

using CornerCoordinates = std::vector<std::array<glm::vec2, 3>>;  // by triangle

// Equal coordinates at one vertex are one wedge.
void set_corners(TriangleMesh& mesh, const CornerCoordinates& coordinates) {
  const std::size_t vertices = mesh.positions.size();
  std::vector<std::vector<glm::vec2>> wedges(vertices);  // by vertex
  const auto wedge_at = [&](std::size_t t, int i) {
    std::vector<glm::vec2>& of_vertex = wedges[mesh.triangles[t][i]];
    const glm::vec2& wanted = coordinates[t][static_cast<std::size_t>(i)];
    const auto found = std::find(of_vertex.begin(), of_vertex.end(), wanted);
    const auto place = static_cast<std::size_t>(found - of_vertex.begin());
    if (found == of_vertex.end()) of_vertex.push_back(wanted);
    return place;
  };
  std::vector<std::array<std::size_t, 3>> places(mesh.triangles.size());
  for (std::size_t t = 0; t < places.size(); ++t)
    for (int i = 0; i < 3; ++i) places[t][static_cast<std::size_t>(i)] = wedge_at(t, i);
  std::vector<WedgeId> first_extra(vertices);
  mesh.texture_coordinates.resize(vertices);
  for (VertexId v = 0; v < vertices; ++v) {
    first_extra[v] = static_cast<WedgeId>(mesh.positions.size());
    if (!wedges[v].empty()) mesh.texture_coordinates[v] = wedges[v][0];
    for (std::size_t k = 1; k < wedges[v].size(); ++k) {
      mesh.extra_wedges.push_back(v);
      mesh.positions.push_back(mesh.positions[v]);
      mesh.texture_coordinates.push_back(wedges[v][k]);
    }
  }
  if (mesh.extra_wedges.empty()) return;
  mesh.corners = mesh.triangles;
  for (std::size_t t = 0; t < places.size(); ++t)
    for (int i = 0; i < 3; ++i)
      if (const std::size_t place = places[t][static_cast<std::size_t>(i)]; place > 0)
        mesh.corners[t][i] = first_extra[mesh.triangles[t][i]] + static_cast<WedgeId>(place - 1);
}

TriangleMesh cylinder(int around, int along) {
  TriangleMesh mesh;
  CornerCoordinates coordinates;
  for (int j = 0; j <= along; ++j) {
    for (int i = 0; i < around; ++i) {
      const double angle = two_pi * i / around, height = 3.0 * j / along;
      const double radius = 1.0 + 0.08 * std::sin(3.0 * angle + 2.0 * height) + 0.03 * std::cos(7.0 * height - angle);
      mesh.positions.emplace_back(radius * std::cos(angle), height, radius * std::sin(angle));
    }
  }
  const auto id = [&](int i, int j) { return static_cast<VertexId>(j * around + i % around); };
  const auto texture = [&](int i, int j) {
    return glm::vec2(static_cast<double>(i) / around, static_cast<double>(j) / along);
  };
  for (int j = 0; j < along; ++j) {
    for (int i = 0; i < around; ++i) {
      mesh.triangles.emplace_back(id(i, j), id(i, j + 1), id(i + 1, j + 1));
      coordinates.push_back({texture(i, j), texture(i, j + 1), texture(i + 1, j + 1)});
      mesh.triangles.emplace_back(id(i, j), id(i + 1, j + 1), id(i + 1, j));
      coordinates.push_back({texture(i, j), texture(i + 1, j + 1), texture(i + 1, j)});
    }
  }
  set_corners(mesh, coordinates);
  return mesh;
}

// n points spread over the sphere (Fibonacci).
std::vector<glm::dvec3> spread_directions(std::size_t n) {
  const double golden = two_pi * (1.0 - 1.0 / 1.6180339887498949);
  std::vector<glm::dvec3> directions;
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(n);
    const double radius = std::sqrt(1.0 - z * z), angle = golden * static_cast<double>(i);
    directions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return directions;
}

// The nearest of `seeds` for each triangle; every triangle by itself where there are none.
std::vector<std::uint32_t> charts_of(const TriangleMesh& mesh, const std::vector<glm::dvec3>& seeds) {
  std::vector<std::uint32_t> charts;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    std::uint32_t best = seeds.empty() ? t : 0;
    const Triangle& corners = mesh.triangles[t];
    const glm::dvec3 center(mesh.positions[corners.x] + mesh.positions[corners.y] + mesh.positions[corners.z]);
    for (std::uint32_t s = 1; s < seeds.size(); ++s)
      if (glm::dot(seeds[s], center) > glm::dot(seeds[best], center)) best = s;
    charts.push_back(best);
  }
  return charts;
}

// Each chart flat in a cell of its own of a square atlas, all at one scale: along the mean normal of its triangles.
TriangleMesh with_atlas(TriangleMesh mesh, const std::vector<std::uint32_t>& charts) {
  const std::size_t count = 1 + *std::max_element(charts.begin(), charts.end());
  const double cells = std::ceil(std::sqrt(static_cast<double>(count)));
  const auto corner = [&](std::size_t t, int i) { return glm::dvec3(mesh.positions[mesh.triangles[t][i]]); };
  std::vector<glm::dvec3> normals(count, glm::dvec3(0.0));
  for (std::size_t t = 0; t < charts.size(); ++t)
    normals[charts[t]] += glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
  const auto flat = [&](std::size_t t, int i) {
    const glm::dvec3 n = glm::normalize(normals[charts[t]]);
    const glm::dvec3 u = glm::normalize(glm::cross(n, std::abs(n.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    return glm::dvec2(glm::dot(u, corner(t, i)), glm::dot(glm::cross(n, u), corner(t, i)));
  };
  std::vector<glm::dvec2> low(count, glm::dvec2(1e9)), high(count, glm::dvec2(-1e9));
  for (std::size_t t = 0; t < charts.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      low[charts[t]] = glm::min(low[charts[t]], flat(t, i));
      high[charts[t]] = glm::max(high[charts[t]], flat(t, i));
    }
  double size = 0.0;
  for (std::size_t c = 0; c < count; ++c) size = std::max({size, high[c].x - low[c].x, high[c].y - low[c].y});
  CornerCoordinates coordinates(charts.size());
  for (std::size_t t = 0; t < charts.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t c = charts[t];
      const glm::dvec2 cell(std::fmod(c, cells), std::floor(c / cells));
      coordinates[t][static_cast<std::size_t>(i)] = (cell + 0.02 + 0.96 * (flat(t, i) - low[c]) / size) / cells;
    }
  set_corners(mesh, coordinates);
  return mesh;
}

TriangleMesh planet() { return generate("rough-planet", {{"level", 6}}); }

TriangleMesh raw_mesh(const std::string& name) {
  if (name == "cylinder") return cylinder(256, 128);
  if (name == "fragmented") return with_atlas(planet(), charts_of(planet(), {}));
  if (name == "charts") return with_atlas(planet(), charts_of(planet(), spread_directions(1000)));
  return load_bench_mesh(name);
}

}  // namespace

TriangleMesh load_textured_mesh(const std::string& name) {
  TriangleMesh mesh = raw_mesh(name);
  mesh.normals.clear();
  mesh.colors.clear();
  return clean(std::move(mesh), {}, name).mesh;  // without the seams of normals alone
}

std::vector<std::string> available_textured(const std::vector<std::string>& names) {
  std::vector<std::string> found;
  for (const std::string& name : names) {
    const bool is_generated = std::find(generated.begin(), generated.end(), name) != generated.end();
    if (is_generated || !available({name}).empty()) found.push_back(name);
  }
  return found;
}

TriangleMesh geometry_of(const TriangleMesh& mesh) {
  TriangleMesh geometry;
  geometry.positions.assign(mesh.positions.begin(),
                            mesh.positions.begin() + static_cast<std::ptrdiff_t>(mesh.vertex_count()));
  geometry.triangles = mesh.triangles;
  return geometry;
}

}  // namespace occlod::bench
