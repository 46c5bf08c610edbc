// The corners of the stars of a run of splits, and how far they reach from the axis of a cylinder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "splits/star.h"

namespace occlod {

// How far points reach from a centre, and from and along the axis through it. Object units.
struct PointExtents {
  float radius = 0.0F;           // largest distance from the centre
  float cylinder_radius = 0.0F;  // largest distance from the axis
  float t_min = std::numeric_limits<float>::max();
  float t_max = std::numeric_limits<float>::lowest();
};

// Keeps the corners of stars one after the other: those of a subtree in depth-first order are a run.
class StarPoints {
 public:
  void clear() noexcept {
    size_ = 0;
    starts_.resize(1);
  }
  // Adds v and the corners of all faces that its split inserts and removes.
  void add(const SplitStar& star, std::span<const glm::vec3> positions);

  // Returns the extents of the corners of stars [first, end), the numbers of calls of add(). The axis has unit length.
  // The error is a few units in the last place of the radius. The bits are the same with every instruction set. O(n).
  [[nodiscard]] PointExtents extents(std::size_t first, std::size_t end, const glm::vec3& center,
                                     const glm::vec3& axis) const;

 private:
  static constexpr std::size_t padding = 16;  // places that may be read past the end

  void put(const glm::vec3& p) noexcept {
    x_[size_] = p.x;
    y_[size_] = p.y;
    z_[size_++] = p.z;
  }

  std::size_t size_ = 0;
  std::vector<float> x_, y_, z_;  // longer than size_
  std::vector<std::size_t> starts_ = {0};
};

}  // namespace occlod
