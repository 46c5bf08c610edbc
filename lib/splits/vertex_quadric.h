// Quadric error of planes (Garland & Heckbert 1997), weighted by area, around the vertex itself.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace occlod {

// The sum over planes of weight * distance^2 at position + x, as x^T A x + 2 b^T x + c. Being centred on the vertex,
// all numbers are of the size of its neighbourhood, so single precision holds them: the error of a distance is some
// 1e-4 of the length of the edge it is taken over.
struct VertexQuadric {
  float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  glm::vec3 b{0.0F};
  float c = 0;
  float weight = 0;  // sum of the weights of surface planes; those that hold boundaries do not count

  // A plane through the vertex.
  void add_plane(const glm::vec3& normal, float plane_weight) {
    const glm::vec3 n = plane_weight * normal;
    xx += n.x * normal.x, xy += n.x * normal.y, xz += n.x * normal.z;
    yy += n.y * normal.y, yz += n.y * normal.z, zz += n.z * normal.z;
  }

  // Of two collapses of equal quadric error the shorter goes first: on flat surface, where every error is zero, this
  // keeps triangles well shaped.
  static constexpr float edge_length_weight = 1e-8F;
  [[nodiscard]] float inverse_weight() const { return weight > 0.0F ? 1.0F / weight : 0.0F; }
  // Collapses are ordered by this times their mean square: half-way, in powers of the weight, between the mean and the
  // sum of squares. The mean spends triangles on small features, the sum loses them; see
  // docs/decisions/010-between_mean_and_sum_of_squares.md.
  [[nodiscard]] float order() const { return std::sqrt(weight); }
  // What merging the vertex into the one at position + x costs.
  [[nodiscard]] float cost(const glm::vec3& x) const {
    return order() * (mean_square(x) + edge_length_weight * glm::dot(x, x));
  }

  [[nodiscard]] glm::vec3 times(const glm::vec3& x) const {
    return {xx * x.x + xy * x.y + xz * x.z, xy * x.x + yy * x.y + yz * x.z, xz * x.x + yz * x.y + zz * x.z};
  }
  [[nodiscard]] float sum_at(const glm::vec3& x) const { return glm::dot(x, times(x) + 2.0F * b) + c; }
  // The mean square distance at position + x; 0 when no surface was added.
  [[nodiscard]] float mean_square(const glm::vec3& x) const {
    return weight > 0.0F ? std::max(sum_at(x), 0.0F) / weight : 0.0F;
  }

  // Adds the quadric of another vertex, which lies at this one's position - offset.
  void add(const VertexQuadric& o, const glm::vec3& offset) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    b += o.b + o.times(offset);
    c += std::max(o.sum_at(offset), 0.0F);
    weight += o.weight;
  }
};

}  // namespace occlod
