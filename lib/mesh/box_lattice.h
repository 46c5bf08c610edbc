// The surface lattice of a box: cells.x by cells.y by cells.z, welded along its edges, counter-clockwise from outside.
#pragma once

#include <glm/vec3.hpp>

#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

class BoxLattice {
 public:
  explicit BoxLattice(glm::ivec3 cells) : cells_(cells) {}  // each >= 1

  // Calls place(glm::ivec3 lattice point) once a vertex, in the order of their indices: layer by layer upwards.
  template <class Place>
  void for_each_point(Place place) const;

  // Appends 4 (xy + yz + zx) triangles with `first_vertex` added to every index.
  void append_triangles(VertexId first_vertex, std::vector<Triangle>& triangles) const;

 private:
  [[nodiscard]] VertexId index(glm::ivec3 p) const;
  [[nodiscard]] int ring_place(glm::ivec3 p) const;
  void append_side(int axis, bool far, VertexId first_vertex, std::vector<Triangle>& triangles) const;

  glm::ivec3 cells_;
};

template <class Place>
void BoxLattice::for_each_point(Place place) const {
  const int nx = cells_.x;
  const int ny = cells_.y;
  for (int z = 0; z <= cells_.z; ++z) {
    if (z == 0 || z == cells_.z) {
      for (int y = 0; y <= ny; ++y) {
        for (int x = 0; x <= nx; ++x) place(glm::ivec3(x, y, z));
      }
      continue;
    }
    for (int x = 0; x < nx; ++x) place(glm::ivec3(x, 0, z));
    for (int y = 0; y < ny; ++y) place(glm::ivec3(nx, y, z));
    for (int x = nx; x > 0; --x) place(glm::ivec3(x, ny, z));
    for (int y = ny; y > 0; --y) place(glm::ivec3(0, y, z));
  }
}

}  // namespace occlod
