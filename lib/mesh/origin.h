// Chooses the origin of coordinates that need more digits than floats have.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>

#include "occlod/bounds.h"
#include "occlod/mesh.h"

namespace occlod {

// How coordinates become positions: as floats, or relative to an origin.
struct Origin {
  glm::dvec3 at{0.0};
  // Positions are multiples of it: what has equal coordinates in two files whose origins differ stays at one place.
  // A power of two; 0: positions are the coordinates, as floats, and `at` is 0.
  double step = 0.0;

  [[nodiscard]] glm::vec3 position_of(const glm::dvec3& p) const {
    if (step == 0.0) return glm::vec3(p);
    return glm::vec3(glm::round((p - at) / step) * step + 0.0);  // never -0
  }
};

// True when text with the digits of a float may be read relative to an origin: the box is far away for its size.
[[nodiscard]] inline bool is_far(const Box& box) {
  const glm::dvec3 size = glm::dvec3(box.max) - glm::dvec3(box.min);
  const glm::dvec3 reach(glm::max(glm::abs(box.min), glm::abs(box.max)));
  return std::max({reach.x, reach.y, reach.z}) > 8.0 * std::max({size.x, size.y, size.z});
}

// Collects coordinates, and chooses an origin for them where floats would move one by more than a millionth of the
// largest side of their box.
class OriginChooser {
 public:
  // `p` is finite, as floats too.
  void add(const glm::dvec3& p) {
    low_ = glm::min(low_, p);
    high_ = glm::max(high_, p);
    const glm::dvec3 moved = glm::abs(p - glm::dvec3(glm::vec3(p)));
    moved_ = std::max({moved_, moved.x, moved.y, moved.z});
  }
  // True when the box is near enough for its size that no origin is needed, whatever else is added: coordinates of
  // size m outside it make it larger, so that its side stays at least m / 9, and floats move no coordinate by more
  // than m / 2^24.
  [[nodiscard]] bool is_settled() const { return side() > 0.0 && reach() <= 8.0 * side(); }

  [[nodiscard]] Origin choose() const {
    constexpr double allowed = 1e-6;
    if (!(side() > std::numeric_limits<float>::min()) || is_settled() || moved_ <= allowed * side()) return {};
    if (reach() > farthest_coordinate) return {};  // clean() refuses it
    // The middle of the box, on a grid of about an eighth of its side, so that it has few digits.
    Origin origin;
    const double grid = std::ldexp(1.0, std::ilogb(side()) - 3);
    origin.at = glm::round((low_ + (high_ - low_) / 2.0) / grid) * grid + 0.0;
    const glm::dvec3 farthest = glm::max(high_ - origin.at, origin.at - low_);
    const int float_digits = std::numeric_limits<float>::digits;
    origin.step = std::ldexp(1.0, std::ilogb(std::max({farthest.x, farthest.y, farthest.z})) + 1 - float_digits);
    return origin;
  }

 private:
  [[nodiscard]] double side() const {
    const glm::dvec3 size = high_ - low_;
    return std::max({size.x, size.y, size.z});
  }
  [[nodiscard]] double reach() const {
    const glm::dvec3 farthest = glm::max(glm::abs(low_), glm::abs(high_));
    return std::max({farthest.x, farthest.y, farthest.z});
  }

  glm::dvec3 low_{std::numeric_limits<double>::infinity()};
  glm::dvec3 high_{-std::numeric_limits<double>::infinity()};
  double moved_ = 0.0;  // the farthest that floats move a coordinate
};

}  // namespace occlod
