#include "mesh/box_lattice.h"

namespace occlod {

VertexId BoxLattice::index(glm::ivec3 p) const {
  const int layer = (cells_.x + 1) * (cells_.y + 1);
  const int ring = 2 * (cells_.x + cells_.y);
  if (p.z == 0) return static_cast<VertexId>(p.y * (cells_.x + 1) + p.x);
  if (p.z == cells_.z) return static_cast<VertexId>(layer + (p.z - 1) * ring + p.y * (cells_.x + 1) + p.x);
  return static_cast<VertexId>(layer + (p.z - 1) * ring + ring_place(p));
}

int BoxLattice::ring_place(glm::ivec3 p) const {
  if (p.y == 0) return p.x;
  if (p.x == cells_.x) return cells_.x + p.y;
  if (p.y == cells_.y) return cells_.x + cells_.y + (cells_.x - p.x);
  return 2 * cells_.x + cells_.y + (cells_.y - p.y);
}

void BoxLattice::append_triangles(VertexId first_vertex, std::vector<Triangle>& triangles) const {
  for (int axis = 0; axis < 3; ++axis) {
    append_side(axis, false, first_vertex, triangles);
    append_side(axis, true, first_vertex, triangles);
  }
}

// The side across `axis` through the origin, or the far one.
void BoxLattice::append_side(int axis, bool far, VertexId first_vertex, std::vector<Triangle>& triangles) const {
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  for (int j = 0; j < cells_[v]; ++j) {
    for (int i = 0; i < cells_[u]; ++i) {
      const auto at = [&](int du, int dv) {
        glm::ivec3 p(0);
        p[axis] = far ? cells_[axis] : 0;
        p[u] = i + du;
        p[v] = j + dv;
        return first_vertex + index(p);
      };
      const VertexId b = far ? at(1, 0) : at(0, 1);
      const VertexId d = far ? at(0, 1) : at(1, 0);
      triangles.emplace_back(at(0, 0), b, at(1, 1));
      triangles.emplace_back(at(0, 0), at(1, 1), d);
    }
  }
}

}  // namespace occlod
