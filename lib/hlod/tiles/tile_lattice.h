// What the positions of a tile count from.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace occlod::tiles {

// A place from which all positions are exact as floats, for each coordinate: 0 where the box reaches to within half of
// its extent of it, else the middle of the box. Then differences are multiples of the last place of the smallest
// coordinate, and no larger than that coordinate.
[[nodiscard]] glm::dvec3 near_origin(std::span<const glm::vec3> positions);

// The points whose coordinates are multiples of a power of two, near some positions. So two lattices of one step have
// the same points: tiles of about the same size round a vertex that they share to the same place.
class TileLattice {
 public:
  // The finest on which the positions, at least one, take `bits` (at most 16) a coordinate.
  TileLattice(std::span<const glm::vec3> positions, int bits);

  // Object units.
  [[nodiscard]] double step() const noexcept { return step_; }
  // Where integers count from in y-up axes: least x, largest y, least z of the object's axes.
  [[nodiscard]] glm::dvec3 origin() const noexcept;
  // The nearest point, for one of the positions; at (0, 0, 0) are the least coordinates.
  [[nodiscard]] glm::u16vec3 at(const glm::vec3& position) const;
  [[nodiscard]] glm::dvec3 position(const glm::u16vec3& at) const;
  // The largest coordinates.
  [[nodiscard]] const glm::u16vec3& far_end() const noexcept { return far_end_; }

 private:
  double step_;
  glm::dvec3 least_;  // in steps
  glm::u16vec3 far_end_;
};

}  // namespace occlod::tiles
