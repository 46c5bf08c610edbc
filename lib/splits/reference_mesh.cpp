#include "splits/reference_mesh.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>

namespace occlod {

ReferenceMesh::ReferenceMesh(std::span<const glm::vec3> positions, const LevelFaces& levels, CollapseIndex time,
                             std::span<const float> maker_errors)
    : number_of_(positions.size(), no_id) {
  // What ended before is gone; of the rest, what was made by then is there.
  for (FaceId f = levels.first_ended(time); f < levels.face_count(); ++f) {
    const CollapseIndex maker = levels.maker(f);
    if (maker != no_id && maker >= time) continue;
    add_face(levels.corners(f), positions);
    errors_.push_back(maker == no_id ? 0.0F : maker_errors[maker]);
  }
  mean_error_ = std::accumulate(errors_.begin(), errors_.end(), 0.0) / static_cast<double>(face_count());
  link_stars();
}

void ReferenceMesh::add_face(const Triangle& corners, std::span<const glm::vec3> positions) {
  Triangle face;
  for (int k = 0; k < 3; ++k) {
    std::uint32_t& number = number_of_[corners[k]];
    if (number == no_id) {
      number = vertex_count();
      positions_.push_back(positions[corners[k]]);
    }
    face[k] = number;
  }
  faces_.push_back(face);
  const glm::vec3 &a = positions[corners.x], &b = positions[corners.y], &c = positions[corners.z];
  const glm::vec3 center = a + ((b - a) + (c - a)) * (1.0F / 3.0F);
  balls_.push_back({center, std::max({glm::distance(center, a), glm::distance(center, b), glm::distance(center, c)})});
}

void ReferenceMesh::link_stars() {
  first_star_.assign(positions_.size() + 2, 0);
  for (const Triangle& face : faces_)
    for (int k = 0; k < 3; ++k) ++first_star_[face[k] + 2];
  for (std::size_t v = 2; v < first_star_.size(); ++v) first_star_[v] += first_star_[v - 1];
  stars_.resize(first_star_.back());
  for (std::uint32_t f = 0; f < face_count(); ++f)
    for (int k = 0; k < 3; ++k) stars_[first_star_[faces_[f][k] + 1]++] = f;
  first_star_.pop_back();
}

}  // namespace occlod
