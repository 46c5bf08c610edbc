// How far the collapses of many fans move the surface: the bound of change_bound.h, a fan to a lane.
#pragma once

#include <array>
#include <cstddef>

#include "splits/fan.h"

namespace occlod {

// Fans with equally many corners, each with the corner that its vertex is merged into.
class FanMovements {
 public:
  static constexpr std::size_t capacity = 16;  // fans
  template <class T>
  using PerFan = std::array<T, capacity>;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  void clear() noexcept { size_ = 0; }
  // Another one, to merge its vertex into its corner i. After Fan::measure_normals(). Precondition: there is room, and
  // it has as many corners as the others.
  void add(const Fan& fan, std::size_t i);

  // Of each fan, in the units of its offsets. The same bits with every instruction set and whatever else is here.
  [[nodiscard]] PerFan<float> bounds() const;

  // For bounds(). Relative to the vertex, in ring order, beginning with the one that it is merged into.
  struct Corners {
    alignas(64) std::array<PerFan<float>, Fan::most_neighbours> x, y, z;
    alignas(64) PerFan<float> normal_x, normal_y, normal_z;  // Fan::normal_sum()
  };
  [[nodiscard]] const Corners& corners() const noexcept { return corners_; }
  [[nodiscard]] std::size_t corner_count() const noexcept { return corner_count_; }  // of each fan

 private:
  Corners corners_{};
  std::size_t size_ = 0, corner_count_ = 0;
};

}  // namespace occlod
