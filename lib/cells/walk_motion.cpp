#include "cells/walk_motion.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace occlod {
namespace {

constexpr double memory_seconds = 0.2;
constexpr double slope = 0.25;         // how far the eye may leave its course, of the way that it goes
constexpr double walking_speed = 1.4;  // m/s: that an eye may take up at any time
constexpr int most_samples = 64;       // of the course

double distance_to(const CellBox& box, const glm::dvec3& p) {
  return glm::distance(p, glm::clamp(p, box.min, box.max));
}

}  // namespace

void WalkMotion::step(const glm::dvec3& eye, double seconds) {
  const glm::dvec3 way = eye - eye_;
  eye_ = eye;
  if (is_first_ || !(glm::length(way) < jump_)) {
    is_first_ = false;
    velocity_ = glm::dvec3(0.0);
  } else if (seconds > 0.0) {
    velocity_ = glm::mix(velocity_, way / seconds, 1.0 - std::exp(-seconds / memory_seconds));
  }
}

void CellForecast::add(CellId leaf, double seconds) {
  const auto at = std::ranges::find(expected_, leaf, &ExpectedCell::leaf);
  if (at == expected_.end())
    expected_.push_back({leaf, seconds});
  else
    at->seconds = std::min(at->seconds, seconds);
}

const std::vector<ExpectedCell>& CellForecast::expect(CellId leaf, const glm::dvec3& eye, const glm::dvec3& velocity,
                                                      double horizon, std::size_t most) {
  if (leaf != here_) tree_.neighbours(leaf, neighbours_);
  here_ = leaf;
  expected_.clear();
  const double speed = glm::length(velocity), at_least = std::max(speed, walking_speed);
  for (const CellId other : neighbours_) {
    // Ahead it is entered when it is reached, elsewhere only after a turn.
    const CellBox& box = tree_.node(other).box;
    const glm::dvec3 there = glm::clamp(eye, box.min, box.max) - eye;
    const double distance = distance_to(box, eye);
    add(other, distance / at_least + (glm::dot(there, velocity) < 0.0 ? memory_seconds : 0.0));
  }
  // Along the course, in steps of half a cell; the first and the last sample are its ends.
  const CellBox& box = tree_.node(leaf).box;
  const double reach = speed * horizon, edge = std::max(glm::length(box.max - box.min) / 2.0, 1e-12);
  const int samples = static_cast<int>(std::clamp(std::ceil(2.0 * reach / edge), 1.0, double{most_samples}));
  for (int i = 0; speed > 0.0 && i <= samples && expected_.size() < 4 * most; ++i) {
    const double way = reach * i / samples, radius = slope * std::max(way, reach / samples);
    const glm::dvec3 place = eye + velocity * (way / speed);
    tree_.leaves_in({place - radius, place + radius}, found_);
    for (const CellId other : found_)
      if (other != leaf) add(other, way / speed);
  }
  std::ranges::stable_sort(expected_, {}, &ExpectedCell::seconds);
  if (expected_.size() > most) expected_.resize(most);
  return expected_;
}

}  // namespace occlod
