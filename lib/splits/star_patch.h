// What the own faces of one split occupy.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "occlod/hierarchy/split_star.h"
#include "occlod/math/bounds.h"

namespace occlod {

// What the faces of one split, or of a run of splits, occupy: a sphere and the cone of their normals.
struct Patch {
  Sphere sphere;
  glm::vec3 axis{0.0F};
  float cos_angle = 1.0F;  // of the half angle; -1 = every direction
  float sin_angle = 0.0F;
  bool has_normal = false;  // false: only faces without area, which cover no pixel and face nowhere
};

struct BoundedPatch {
  Patch patch;
  Box box;
};

// Of the faces that the split inserts and removes.
[[nodiscard]] BoundedPatch bound_star(const SplitStar& star, std::span<const glm::vec3> positions);

// Factors that keep bounds outside through roundings: differences of single-precision positions are correct to half a
// unit in their own last place, and no sum is longer than a dozen terms.
inline constexpr float grow = 1.0F + 4e-6F;
inline constexpr float cone_slack = 4e-6F;
// A corner whose squared sine is that small or smaller needs double precision; of any other, single precision gives the
// normal to within normal_slack.
inline constexpr float min_sin2 = 0.0025F;
inline constexpr float normal_slack = 1e-5F;
// What roundings make of numbers so small that their last place no longer shrinks with them: some twenty of it.
inline constexpr float denormal_slack = 3e-44F;

// Also of vectors whose squares no float holds.
[[nodiscard]] inline float length_of(const glm::vec3& v) {
  const float square = glm::dot(v, v);
  return square > 1e-30F && square < 1e30F ? std::sqrt(square) : static_cast<float>(glm::length(glm::dvec3(v)));
}

}  // namespace occlod
