#include "hlod/tiles/tile_lattice.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/common.hpp>

#include "occlod/math/bounds.h"

namespace occlod::tiles {
namespace {

glm::dvec3 rounded(const glm::dvec3& v) { return {std::nearbyint(v.x), std::nearbyint(v.y), std::nearbyint(v.z)}; }

double largest(const glm::dvec3& v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

glm::dvec3 near_origin(std::span<const glm::vec3> positions) {
  const Box box = bounding_box(positions);
  glm::dvec3 origin(0.0);
  for (int k = 0; k < 3; ++k) {
    const double least = box.min[k], most = box.max[k];
    const double nearest = least > 0.0 ? least : most < 0.0 ? -most : 0.0;
    if (nearest > (most - least) / 2.0) origin[k] = static_cast<double>(static_cast<float>((least + most) / 2.0));
  }
  return origin;
}

TileLattice::TileLattice(std::span<const glm::vec3> positions, int bits) {
  assert(!positions.empty() && bits >= 1 && bits <= 16);
  const Box box = bounding_box(positions);
  const glm::dvec3 low(box.min), high(box.max);
  const double most_steps = std::exp2(bits) - 1.0;
  // Doubles hold 53 bits, of which the place itself takes some.
  const double farthest = largest(glm::max(glm::abs(low), glm::abs(high)));
  const double finest = std::max({largest(high - low) / most_steps, std::ldexp(farthest, -50), std::ldexp(1.0, -149)});
  step_ = std::exp2(std::ceil(std::log2(finest)));
  // Rounding may add a step.
  while (largest(rounded(high / step_) - rounded(low / step_)) > most_steps) step_ *= 2.0;
  least_ = rounded(low / step_);
  far_end_ = glm::u16vec3(rounded(high / step_) - least_);
}

glm::dvec3 TileLattice::origin() const noexcept {
  return glm::dvec3(least_.x, least_.y + far_end_.y, least_.z) * step_;
}

glm::u16vec3 TileLattice::at(const glm::vec3& position) const {
  return glm::u16vec3(rounded(glm::dvec3(position) / step_) - least_);
}

glm::dvec3 TileLattice::position(const glm::u16vec3& at) const { return (least_ + glm::dvec3(at)) * step_; }

}  // namespace occlod::tiles
