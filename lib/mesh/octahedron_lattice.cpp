#include "mesh/octahedron_lattice.h"

namespace occlod {

OctahedronLattice::OctahedronLattice(int subdivisions) : n_(1 << subdivisions) {
  warp_.reserve(size_t_n() + 1);
  for (int i = 0; i <= n_; ++i) warp_.push_back(sine_of_quarter_turns(static_cast<double>(i) / n_));
}

void OctahedronLattice::append_bands(std::size_t first_ring, std::size_t last_ring, VertexId first_vertex,
                                     std::vector<Triangle>& triangles) const {
  const auto vertex_of = [&](std::size_t ring) {
    return first_vertex + static_cast<VertexId>(ring_start(ring) - ring_start(first_ring));
  };
  for (std::size_t ring = first_ring; ring < last_ring; ++ring) {
    const VertexId above = vertex_of(ring), below = vertex_of(ring + 1);
    const auto m = static_cast<int>(ring);
    if (m < n_)
      append_band(above, below, m, true, triangles);
    else
      append_band(below, above, 2 * n_ - 1 - m, false, triangles);
  }
}

std::size_t OctahedronLattice::ring_start(std::size_t ring) const noexcept {
  if (ring == 0) return 0;
  if (ring <= size_t_n()) return 1 + 2 * ring * (ring - 1);
  const std::size_t m = 2 * size_t_n() - ring;
  return vertex_count() - 1 - 2 * m * (m + 1);
}

// The band between the ring of 4 m points that starts at `narrow` and that of 4 (m + 1) points at `wide`.
void OctahedronLattice::append_band(VertexId narrow, VertexId wide, int m, bool north,
                                    std::vector<Triangle>& triangles) const {
  const auto inner = static_cast<VertexId>(m);
  const VertexId outer = inner + 1;
  const auto push = [&](VertexId a, VertexId b, VertexId c) {
    triangles.push_back(north ? Triangle(a, b, c) : Triangle(a, c, b));
  };
  for (VertexId quadrant = 0; quadrant < 4; ++quadrant) {
    const auto near_pole = [&](VertexId i) { return m == 0 ? narrow : narrow + (quadrant * inner + i) % (4 * inner); };
    const auto far_from_pole = [&](VertexId i) { return wide + (quadrant * outer + i) % (4 * outer); };
    for (VertexId i = 0; i < outer; ++i) {
      push(near_pole(i), far_from_pole(i), far_from_pole(i + 1));
      if (i < inner) push(near_pole(i), far_from_pole(i + 1), near_pole(i + 1));
    }
  }
}

}  // namespace occlod
