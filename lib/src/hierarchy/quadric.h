// Quadric error of planes (Garland & Heckbert 1997), weighted by area.
#pragma once

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace occlod {

// The sum over planes of weight * distance^2, as x^T A x + 2 b^T x + c around the object's own origin. Double
// precision: the sum of squares of a large model's coordinates cancels far beyond what single precision holds.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  glm::dvec3 b{0.0};
  double c = 0;
  double weight = 0;  // sum of the weights of surface planes; those that hold boundaries do not count

  // The plane dot(normal, x) + offset = 0 with unit normal.
  void add_plane(const glm::dvec3& normal, double offset, double plane_weight) {
    xx += plane_weight * normal.x * normal.x;
    xy += plane_weight * normal.x * normal.y;
    xz += plane_weight * normal.x * normal.z;
    yy += plane_weight * normal.y * normal.y;
    yz += plane_weight * normal.y * normal.z;
    zz += plane_weight * normal.z * normal.z;
    b += plane_weight * offset * normal;
    c += plane_weight * offset * offset;
  }

  Quadric& operator+=(const Quadric& o) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    b += o.b;
    c += o.c;
    weight += o.weight;
    return *this;
  }

  // The mean square distance of p from the planes; 0 when nothing was added.
  [[nodiscard]] double mean_square(const glm::dvec3& p) const {
    if (!(weight > 0.0)) return 0.0;
    const double sum = p.x * (xx * p.x + 2.0 * (xy * p.y + xz * p.z)) + p.y * (yy * p.y + 2.0 * yz * p.z) +
                       zz * p.z * p.z + 2.0 * glm::dot(b, p) + c;
    return std::max(sum, 0.0) / weight;
  }
};

}  // namespace occlod
