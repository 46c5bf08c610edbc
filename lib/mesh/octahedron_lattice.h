// The lattice |x| + |y| + |z| = n on an octahedron, in rings of equal z from the north pole (0, 0, n) down: ring m has
// 4 m points (the poles one), so indices follow from (ring, place in the ring) and no map of edges is needed.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "base/portable_math.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

class OctahedronLattice {
 public:
  explicit OctahedronLattice(int subdivisions);

  [[nodiscard]] std::size_t vertex_count() const noexcept { return 4 * size_t_n() * size_t_n() + 2; }
  [[nodiscard]] std::size_t triangle_count() const noexcept { return 8 * size_t_n() * size_t_n(); }

  // Rings of equal z, from 0 at the north pole.
  [[nodiscard]] std::size_t ring_count() const noexcept { return 2 * size_t_n() + 1; }
  // The index of the first vertex of a ring.
  [[nodiscard]] std::size_t ring_start(std::size_t ring) const noexcept;

  // Calls visit(direction) once a vertex of a ring in the order of their indices. Directions have unit length (to a few
  // ulp).
  template <class Visit>
  void for_each_direction(std::size_t ring, Visit visit) const;

  // Appends the triangles, counter-clockwise from outside, with `first_vertex` added to every index.
  void append_triangles(VertexId first_vertex, std::vector<Triangle>& triangles) const {
    append_bands(0, ring_count() - 1, first_vertex, triangles);
  }
  // The same of those between the rings first_ring and last_ring, whose first vertex gets the number first_vertex.
  void append_bands(std::size_t first_ring, std::size_t last_ring, VertexId first_vertex,
                    std::vector<Triangle>& triangles) const;

 private:
  [[nodiscard]] std::size_t size_t_n() const noexcept { return static_cast<std::size_t>(n_); }
  [[nodiscard]] double warped(int coordinate) const noexcept {
    return coordinate < 0 ? -warp_[static_cast<std::size_t>(-coordinate)] : warp_[static_cast<std::size_t>(coordinate)];
  }
  [[nodiscard]] glm::dvec3 direction(int x, int y, int z) const noexcept;
  void append_band(VertexId narrow, VertexId wide, int m, bool north, std::vector<Triangle>& triangles) const;

  int n_;                     // edges along each edge of the octahedron
  std::vector<double> warp_;  // sin(pi/2 * i/n): with it, areas on the sphere differ by a factor of 1.7 instead of 5.2
};

template <class Visit>
void OctahedronLattice::for_each_direction(std::size_t ring, Visit visit) const {
  const int z = n_ - static_cast<int>(ring);
  const int m = n_ - std::abs(z);
  if (m == 0) visit(direction(0, 0, z));
  for (int i = 0; i < m; ++i) visit(direction(m - i, i, z));
  for (int i = 0; i < m; ++i) visit(direction(-i, m - i, z));
  for (int i = 0; i < m; ++i) visit(direction(i - m, -i, z));
  for (int i = 0; i < m; ++i) visit(direction(i, i - m, z));
}

inline glm::dvec3 OctahedronLattice::direction(int x, int y, int z) const noexcept {
  const glm::dvec3 p(warped(x), warped(y), warped(z));
  return p / std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
}

}  // namespace occlod
