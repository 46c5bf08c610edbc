// The quick way for the usual vertex: one closed fan of faces, all wound alike, none at a feature edge.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>

#include "star_mesh.h"

namespace occlod {

// The ring of neighbours of such a vertex, in order, and what its collapses have in common. Positions are relative to
// the vertex.
class Fan {
 public:
  static constexpr std::size_t most_neighbours = 24;

  // False when the star of v is no closed fan, or too large; nothing else may be asked then.
  [[nodiscard]] bool gather(const StarMesh& mesh, VertexId v);
  // After gather(): positions and normals of the fan.
  void measure(std::span<const glm::vec3> positions);

  [[nodiscard]] VertexId vertex() const noexcept { return vertex_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::span<const VertexId> ring() const noexcept { return {ring_.data(), size_}; }
  [[nodiscard]] const glm::vec3& offset(std::size_t i) const noexcept { return offsets_[i]; }  // ring()[i] - v

  // The same three questions that collapse_rules.h and change_bound.h answer for any star, for merging v into
  // ring()[i].
  [[nodiscard]] bool keeps_topology(const StarMesh& mesh, std::size_t i) const;
  [[nodiscard]] bool keeps_orientation(std::size_t i) const;
  [[nodiscard]] float change_bound(std::size_t i) const;

 private:
  [[nodiscard]] std::size_t after(std::size_t i) const noexcept { return i + 1 == size_ ? 0 : i + 1; }
  [[nodiscard]] std::size_t before(std::size_t i) const noexcept { return i == 0 ? size_ - 1 : i - 1; }

  VertexId vertex_ = no_id;
  std::size_t size_ = 0;
  std::array<VertexId, most_neighbours> ring_{};
  std::array<glm::vec3, most_neighbours> offsets_{};
  std::array<glm::vec3, most_neighbours> normals_{};  // of the face between ring i and its next, twice its area long
};

}  // namespace occlod
