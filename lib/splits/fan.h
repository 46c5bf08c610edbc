// Quadric error of planes (Garland & Heckbert 1997), weighted by area and centred on the vertex itself.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "splits/star_mesh.h"

namespace occlod {

// Represents the sum over planes of weight * distance^2 at position + x, as x^T A x + 2 b^T x + c. Because it is
// centred on the vertex, all numbers have the magnitude of its neighbourhood and single precision is enough: the error
// of a distance is about 1e-4 of the length of the edge over which it is taken.
struct VertexQuadric {
  float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  glm::vec3 b{0.0F};
  float c = 0;
  float weight = 0;  // sum of the weights of surface planes; boundary planes do not count

  // Adds a plane through the vertex.
  void add_plane(const glm::vec3& normal, float plane_weight) {
    const glm::vec3 n = plane_weight * normal;
    xx += n.x * normal.x, xy += n.x * normal.y, xz += n.x * normal.z;
    yy += n.y * normal.y, yz += n.y * normal.z, zz += n.z * normal.z;
  }

  // Orders collapses of equal quadric error by edge length: on a flat surface, where every error is zero, this keeps
  // triangles well shaped.
  static constexpr float edge_length_weight = 1e-8F;
  [[nodiscard]] float inverse_weight() const { return weight > 0.0F ? 1.0F / weight : 0.0F; }
  // Collapses are ordered by this factor times their mean square error: in powers of the weight, half-way between the
  // mean and the sum of squares. The mean spends triangles on small features, the sum loses them; see
  // docs/internals/decisions.md#10-between-mean-and-sum-of-squares.
  [[nodiscard]] float order() const { return std::sqrt(weight); }
  // Returns the cost of merging the vertex into the one at position + x.
  [[nodiscard]] float cost(const glm::vec3& x) const {
    return order() * (mean_square(x) + edge_length_weight * glm::dot(x, x));
  }

  [[nodiscard]] glm::vec3 times(const glm::vec3& x) const {
    return {xx * x.x + xy * x.y + xz * x.z, xy * x.x + yy * x.y + yz * x.z, xz * x.x + yz * x.y + zz * x.z};
  }
  [[nodiscard]] float sum_at(const glm::vec3& x) const { return glm::dot(x, times(x) + 2.0F * b) + c; }
  // Returns the mean squared distance at position + x; 0 when no surface was added.
  [[nodiscard]] float mean_square(const glm::vec3& x) const {
    return weight > 0.0F ? std::max(sum_at(x), 0.0F) / weight : 0.0F;
  }

  // Returns the minimum of the sum, relative to the vertex: held near the vertex where the planes leave it open, 0
  // without planes.
  [[nodiscard]] glm::vec3 minimum() const {
    constexpr double hold = 1e-3;  // of the mean of the three weights
    const double extra = hold * (double{xx} + double{yy} + double{zz}) / 3.0;
    const double a11 = xx + extra, a22 = yy + extra, a33 = zz + extra, a12 = xy, a13 = xz, a23 = yz;
    const glm::dvec3 row_x(a22 * a33 - a23 * a23, a13 * a23 - a12 * a33, a12 * a23 - a13 * a22);
    const double determinant = a11 * row_x.x + a12 * row_x.y + a13 * row_x.z;
    if (!(determinant > 0.0)) return glm::vec3(0.0F);
    const glm::dvec3 row_y(row_x.y, a11 * a33 - a13 * a13, a12 * a13 - a11 * a23);
    const glm::dvec3 row_z(row_x.z, row_y.z, a11 * a22 - a12 * a12), right(-b);
    return glm::vec3(glm::dvec3(glm::dot(row_x, right), glm::dot(row_y, right), glm::dot(row_z, right)) / determinant);
  }

  // Adds the quadric of another vertex, which lies at this one's position - offset.
  void add(const VertexQuadric& o, const glm::vec3& offset) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    b += o.b + o.times(offset);
    c += std::max(o.sum_at(offset), 0.0F);
    weight += o.weight;
  }
};

// Handles the most common vertex fast: one closed fan of faces, all wound alike, none at a feature edge.

// Holds the ring of neighbours of such a vertex, in order, and the data that its collapses share. Positions are
// relative to the vertex. Each coordinate has its own array, padded to a multiple of eight, so that loops vectorize and
// most have one length.
class Fan {
 public:
  static constexpr std::size_t max_neighbours = 24;

  // Returns false when the star of v is not such a ring, or is too large; then no other member may be called.
  [[nodiscard]] bool gather(const StarMesh& mesh, VertexId v);
  // Stores the positions of the neighbours, after gather(); position_of(w) returns a glm::vec3.
  template <typename PositionOf>
  void measure_offsets(const PositionOf& position_of);
  // Computes the normals of the fan, after measure_offsets().
  void measure_normals();

  [[nodiscard]] VertexId vertex() const noexcept { return vertex_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::span<const VertexId> ring() const noexcept { return {ring_.data(), size_}; }

  // Returns the quadric of the fan's planes, weighted by area, after measure_normals().
  [[nodiscard]] VertexQuadric quadric() const;
  // Returns the sum over the faces of their normals times twice their area, after measure_normals().
  [[nodiscard]] glm::vec3 normal_sum() const;
  // Returns ring()[i] minus the vertex's position, after measure_offsets().
  [[nodiscard]] glm::vec3 offset(std::size_t i) const noexcept { return {x_[i], y_[i], z_[i]}; }
  // Returns the cost of merging the vertex, whose quadric is given, into each of its neighbours, after
  // measure_offsets().
  [[nodiscard]] std::span<float> costs(const VertexQuadric& quadric);

  // Answers, for merging v into ring()[i], the two questions that collapse_rules.h answers for any star. FanMovements
  // computes the bound of ChangeBound.
  [[nodiscard]] bool keeps_topology(const StarMesh& mesh, std::size_t i) const;
  [[nodiscard]] bool keeps_orientation(std::size_t i) const;

 private:
  using Row = std::array<float, max_neighbours + 4>;  // one column per neighbour; the first is repeated at the end

  [[nodiscard]] std::size_t after(std::size_t i) const noexcept { return i + 1 == size_ ? 0 : i + 1; }
  [[nodiscard]] std::size_t before(std::size_t i) const noexcept { return i == 0 ? size_ - 1 : i - 1; }
  // the mask shows compilers a multiple of eight
  [[nodiscard]] std::size_t columns() const noexcept { return padded_ & ~std::size_t{7}; }

  VertexId vertex_ = no_id;
  std::size_t size_ = 0;
  std::size_t padded_ = 0;                                // size_, rounded up to a multiple of eight
  std::array<VertexId, max_neighbours> ring_{};           // padded with no_id
  std::array<VertexId, max_neighbours> around_{};         // padded with its first vertex
  alignas(16) Row x_{}, y_{}, z_{};                       // ring()[i] - v
  alignas(16) Row normal_x_{}, normal_y_{}, normal_z_{};  // of the face between ring i and i + 1, twice its area long
  alignas(16) Row area2_{};                               // squared lengths of these normals
  alignas(16) Row costs_{};
};

template <typename PositionOf>
void Fan::measure_offsets(const PositionOf& position_of) {
  const glm::vec3 origin = position_of(vertex_);
  for (std::size_t i = 0; i < columns(); ++i) {
    const glm::vec3& p = position_of(around_[i]);
    x_[i] = p.x - origin.x;
    y_[i] = p.y - origin.y;
    z_[i] = p.z - origin.z;
  }
  x_[padded_] = x_[0];
  y_[padded_] = y_[0];
  z_[padded_] = z_[0];
}

// Bounds how far the collapses of many fans move the surface: the bound of ChangeBound, with one fan per SIMD lane.

// Holds fans with equally many corners, each with the corner into which its vertex is merged.
class FanMovements {
 public:
  static constexpr std::size_t capacity = 16;  // number of fans
  template <class T>
  using PerFan = std::array<T, capacity>;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  void clear() noexcept { size_ = 0; }
  // Adds a fan whose vertex is merged into its corner i, after Fan::measure_normals(). Precondition: there is room, and
  // it has as many corners as the others.
  void add(const Fan& fan, std::size_t i);

  // Returns the bound of each fan, in the units of its offsets. The bits are the same with every instruction set and do
  // not depend on the other fans.
  [[nodiscard]] PerFan<float> bounds() const;

  // Input of bounds(): corners relative to the vertex, in ring order, beginning with the one into which it is merged.
  struct Corners {
    alignas(64) std::array<PerFan<float>, Fan::max_neighbours> x, y, z;
    alignas(64) PerFan<float> normal_x, normal_y, normal_z;  // Fan::normal_sum()
  };
  [[nodiscard]] const Corners& corners() const noexcept { return corners_; }
  [[nodiscard]] std::size_t corner_count() const noexcept { return corner_count_; }  // per fan

 private:
  Corners corners_{};
  std::size_t size_ = 0, corner_count_ = 0;
};

}  // namespace occlod
