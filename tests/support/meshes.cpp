#include "support/meshes.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "occlod/generate.h"

namespace occlod::test {
namespace {

constexpr double two_pi = 6.28318530717958647692;

// The corners of a regular n-gon, as a parameter in [0, 2 pi).
double turn(int i, int n) { return two_pi * i / n; }

VertexId id(int i) { return static_cast<VertexId>(i); }

// Two triangles for the cell a-b-c-d, counter-clockwise, cut along a-c.
void push_cell(TriangleMesh& mesh, VertexId a, VertexId b, VertexId c, VertexId d) {
  mesh.triangles.emplace_back(a, b, c);
  mesh.triangles.emplace_back(a, c, d);
}

}  // namespace

TriangleMesh single_triangle() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

TriangleMesh grid(int nx, int ny) {
  TriangleMesh mesh;
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) {
      mesh.positions.emplace_back(static_cast<double>(i) / nx, static_cast<double>(j) / ny, 0.0);
    }
  }
  const auto at = [nx](int i, int j) { return id(j * (nx + 1) + i); };
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) push_cell(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  }
  return mesh;
}

TriangleMesh fan(int n) {
  TriangleMesh mesh;
  mesh.positions.emplace_back(0.0f);
  for (int i = 0; i < n; ++i) {
    mesh.positions.emplace_back(std::cos(turn(i, n)), std::sin(turn(i, n)), 0.0);
    mesh.triangles.emplace_back(0u, id(1 + i), id(1 + (i + 1) % n));
  }
  return mesh;
}

TriangleMesh moebius(int n) {
  TriangleMesh mesh;
  for (int side = -1; side <= 1; side += 2) {
    for (int i = 0; i < n; ++i) {
      const double u = turn(i, n);
      const double radius = 1.0 + 0.3 * side * std::cos(u / 2);
      mesh.positions.emplace_back(radius * std::cos(u), radius * std::sin(u), 0.3 * side * std::sin(u / 2));
    }
  }
  for (int i = 0; i + 1 < n; ++i) push_cell(mesh, id(i), id(i + 1), id(n + i + 1), id(n + i));
  push_cell(mesh, id(n - 1), id(n), id(0), id(2 * n - 1));  // the half twist: the sides change places
  return mesh;
}

TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

TriangleMesh octahedron_sphere(int level) { return generate("rough-planet", {{"level", level}, {"amplitude", 0.0}}); }

TriangleMesh noisy_sphere(int level, std::uint64_t seed) {
  return generate("rough-planet", {{"level", level}, {"seed", seed}});
}

TriangleMesh torus(int nu, int nv) {
  TriangleMesh mesh;
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      const double radius = 1.0 + 0.4 * std::cos(turn(j, nv));
      mesh.positions.emplace_back(radius * std::cos(turn(i, nu)), radius * std::sin(turn(i, nu)),
                                  0.4 * std::sin(turn(j, nv)));
    }
  }
  const auto at = [nu, nv](int i, int j) { return id((i % nu) * nv + j % nv); };
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) push_cell(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  }
  return mesh;
}

TriangleMesh double_sided_quad() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 2, 1}, {0, 3, 2}};
  return mesh;
}

TriangleMesh bow_tie() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  return mesh;
}

TriangleMesh book(int pages) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 1}};
  for (int i = 0; i < pages; ++i) {
    const double angle = 0.5 * turn(i, pages);
    mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.5);
    mesh.triangles.emplace_back(0u, 1u, id(2 + i));
  }
  return mesh;
}

TriangleMesh two_components() {
  TriangleMesh mesh = tetrahedron();
  append(mesh, octahedron_sphere(0), {4, 0, 0});
  return mesh;
}

TriangleMesh many_tetrahedra(int n) {
  TriangleMesh mesh;
  for (int i = 0; i < n; ++i) append(mesh, tetrahedron(), {2.0f * static_cast<float>(i), 0, 0});
  return mesh;
}

double area_of(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    area += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  return area;
}

void append(TriangleMesh& mesh, const TriangleMesh& part, const glm::vec3& offset) {
  const auto first = static_cast<VertexId>(mesh.vertex_count());
  for (const glm::vec3& p : part.positions) mesh.positions.push_back(p + offset);
  for (const Triangle& t : part.triangles) mesh.triangles.push_back(t + Triangle(first));
}

}  // namespace occlod::test
