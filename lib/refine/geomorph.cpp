#include "occlod/refine/geomorph.h"

#include <algorithm>
#include <glm/common.hpp>

namespace occlod {

MorphedPositions::MorphedPositions(std::span<const glm::vec3> positions)
    : own_(positions), drawn_(positions.begin(), positions.end()) {}

void MorphedPositions::update(std::span<const Geomorph> geomorphs) {
  for (const VertexId v : under_way_) drawn_[v] = own_[v];
  moved_.swap(under_way_);
  under_way_.clear();
  for (const Geomorph& g : geomorphs) {
    drawn_[g.vertex] = glm::mix(drawn_[g.parent], own_[g.vertex], g.t);
    under_way_.push_back(g.vertex);
  }
  moved_.insert(moved_.end(), under_way_.begin(), under_way_.end());
  std::sort(moved_.begin(), moved_.end());
  moved_.erase(std::unique(moved_.begin(), moved_.end()), moved_.end());
}

}  // namespace occlod
