// A star that is one fan, looked at from one eye: a face to a lane.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>

#include "occlod/hierarchy/split_star.h"
#include "occlod/math/bounds.h"

namespace occlod {

// The corners of a fan, one coordinate after the other.
struct FanCorners {
  // The ring, its first vertex once more, and whatever fills the last vector.
  static constexpr std::size_t most_lanes = 16;
  static constexpr std::size_t capacity = SplitStar::most_ring + 1 + most_lanes;
  using Lanes = std::array<float, capacity>;

  alignas(64) Lanes x, y, z;
  glm::vec3 vertex;                // in the middle
  std::uint32_t ring_size = 0;     // vertices around it
  std::uint32_t inserted = 0;      // faces: between the first this many neighbours
  std::uint32_t parent_place = 0;  // in the ring, of the vertex that removed faces meet in

  void set(std::size_t place, const glm::vec3& p) {
    x[place] = p.x;
    y[place] = p.y;
    z[place] = p.z;
  }
  // When all neighbours are set.
  void fill_up();
};

// The middle of the corners' box, and how far they are from it.
[[nodiscard]] Sphere sphere_around(const FanCorners& corners);

struct SeenFaces {
  std::uint32_t count = 0;
  float whole = 0.0F;   // sum of twice their areas
  float facing = 0.0F;  // of the parts of these that face the eye
};
// Inserted faces, then removed ones, added up in this order with every instruction set.
[[nodiscard]] SeenFaces fan_visibility(const FanCorners& corners, const glm::vec3& eye, bool two_sided);

}  // namespace occlod
