// The fast path for the usual vertex: one closed fan of faces, all wound alike, none at a feature edge.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "splits/star_mesh.h"
#include "splits/vertex_quadric.h"

namespace occlod {

// The ring of neighbours of such a vertex, in order, and what its collapses have in common. Positions are relative to
// the vertex. Loops run over arrays of one coordinate each, filled up to a multiple of four, so that they vectorize.
class Fan {
 public:
  static constexpr std::size_t most_neighbours = 24;

  // False when the star of v is no ring, or too large; nothing else may be asked then.
  [[nodiscard]] bool gather(const StarMesh& mesh, VertexId v);
  // After gather(): where the neighbours are; position_of(w) is a glm::vec3.
  template <typename PositionOf>
  void measure_offsets(const PositionOf& position_of);
  // After measure_offsets(): the normals of the fan.
  void measure_normals();

  [[nodiscard]] VertexId vertex() const noexcept { return vertex_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::span<const VertexId> ring() const noexcept { return {ring_.data(), size_}; }

  // After measure_normals(): the planes of its faces, weighted by area.
  [[nodiscard]] VertexQuadric quadric() const;
  // After measure_normals(): twice the area of each face along its normal, all together.
  [[nodiscard]] glm::vec3 normal_sum() const;
  // After measure_offsets(): where ring()[i] is from the vertex.
  [[nodiscard]] glm::vec3 offset(std::size_t i) const noexcept { return {x_[i], y_[i], z_[i]}; }
  // After measure_offsets(): the cost of merging the vertex, whose quadric is given, into each of its neighbours.
  [[nodiscard]] std::span<float> costs(const VertexQuadric& quadric);

  // The same two questions that collapse_rules.h answers for any star, for merging v into ring()[i]; change_bound.h's
  // is answered by FanMovements.
  [[nodiscard]] bool keeps_topology(const StarMesh& mesh, std::size_t i) const;
  [[nodiscard]] bool keeps_orientation(std::size_t i) const;

 private:
  using Row = std::array<float, most_neighbours + 4>;  // a column for each neighbour; the first once more at the end

  [[nodiscard]] std::size_t after(std::size_t i) const noexcept { return i + 1 == size_ ? 0 : i + 1; }
  [[nodiscard]] std::size_t before(std::size_t i) const noexcept { return i == 0 ? size_ - 1 : i - 1; }
  [[nodiscard]] std::size_t columns() const noexcept { return padded_ & ~std::size_t{3}; }  // so that compilers know

  VertexId vertex_ = no_id;
  std::size_t size_ = 0;
  std::size_t padded_ = 0;  // size_, rounded up to a multiple of four
  std::array<VertexId, most_neighbours> ring_{};
  alignas(16) Row x_{}, y_{}, z_{};                       // ring()[i] - v
  alignas(16) Row normal_x_{}, normal_y_{}, normal_z_{};  // of the face between ring i and its next, twice its area
  alignas(16) Row area2_{};                               // their squared lengths
  alignas(16) Row costs_{};
};

template <typename PositionOf>
void Fan::measure_offsets(const PositionOf& position_of) {
  const glm::vec3 origin = position_of(vertex_);
  for (std::size_t i = 0; i < size_; ++i) {
    const glm::vec3& p = position_of(ring_[i]);
    x_[i] = p.x - origin.x;
    y_[i] = p.y - origin.y;
    z_[i] = p.z - origin.z;
  }
  for (std::size_t i = size_; i <= padded_; ++i) {
    x_[i] = x_[0];
    y_[i] = y_[0];
    z_[i] = z_[0];
  }
}

}  // namespace occlod
