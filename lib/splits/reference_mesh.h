// One mesh of the sequence, kept to measure the faces of coarser ones against.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "splits/level_faces.h"

namespace occlod {

// The faces that are there before collapse `time`. Vertices have numbers of their own.
class ReferenceMesh {
 public:
  // `maker_errors`: one for each collapse before `time`, how far the faces that it made are from the input at most.
  ReferenceMesh(std::span<const glm::vec3> positions, const LevelFaces& levels, CollapseIndex time,
                std::span<const float> maker_errors);

  [[nodiscard]] std::uint32_t vertex_count() const noexcept { return static_cast<std::uint32_t>(positions_.size()); }
  [[nodiscard]] std::uint32_t face_count() const noexcept { return static_cast<std::uint32_t>(faces_.size()); }
  [[nodiscard]] const glm::vec3& position(std::uint32_t v) const noexcept { return positions_[v]; }
  // By the number that the vertex has in the input; no_id when it is not there any more.
  [[nodiscard]] std::uint32_t vertex_of(VertexId v) const noexcept { return number_of_[v]; }
  [[nodiscard]] const Triangle& corners(std::uint32_t face) const noexcept { return faces_[face]; }
  [[nodiscard]] float error(std::uint32_t face) const noexcept { return errors_[face]; }
  [[nodiscard]] double mean_error() const noexcept { return mean_error_; }
  [[nodiscard]] std::span<const std::uint32_t> star(std::uint32_t v) const noexcept {
    return {stars_.data() + first_star_[v], first_star_[v + 1] - first_star_[v]};
  }
  // Holds the face.
  struct Ball {
    glm::vec3 center;
    float radius;
  };
  [[nodiscard]] const Ball& ball(std::uint32_t face) const noexcept { return balls_[face]; }

 private:
  void add_face(const Triangle& corners, std::span<const glm::vec3> positions);
  void link_stars();

  std::vector<std::uint32_t> number_of_;
  std::vector<glm::vec3> positions_;
  std::vector<Ball> balls_;
  std::vector<Triangle> faces_;
  std::vector<float> errors_;
  double mean_error_ = 0.0;
  std::vector<std::uint32_t> first_star_;
  std::vector<std::uint32_t> stars_;
};

}  // namespace occlod
