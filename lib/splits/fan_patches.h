// What the own faces of many splits occupy: those of bound_star(), a closed fan to a lane.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "occlod/core/ids.h"
#include "splits/star_patch.h"

namespace occlod {

// Of each fan what bound_star() says of it.
struct FanPatchBounds {
  static constexpr std::size_t capacity = 16;  // fans
  using PerFan = std::array<float, capacity>;

  alignas(64) PerFan min_x, min_y, min_z, max_x, max_y, max_z;
  alignas(64) PerFan center_x, center_y, center_z, radius, axis_x, axis_y, axis_z, cos_angle, sin_angle;
  alignas(64) PerFan is_bounded;  // 0: only bound_star() can tell, for there are slivers, or lengths are extreme

  [[nodiscard]] BoundedPatch operator[](std::size_t i) const noexcept;
};

// Closed fans with equally many corners.
class FanPatches {
 public:
  static constexpr std::size_t capacity = FanPatchBounds::capacity;
  static constexpr std::size_t most_corners = 24;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  void clear() noexcept { size_ = 0; }
  // Another one, of the split that brings back v beside the corner `parent`. Precondition: there is room, and it has as
  // many corners as the others.
  void add(VertexId v, std::span<const VertexId> ring, VertexId parent, std::span<const glm::vec3> positions);

  // The same bits with every instruction set and whatever else is here.
  [[nodiscard]] FanPatchBounds bounds() const;

  // For bounds(). In ring order.
  struct Corners {
    using PerFan = FanPatchBounds::PerFan;
    alignas(64) std::array<PerFan, most_corners> x, y, z;
    alignas(64) PerFan vertex_x, vertex_y, vertex_z;  // in the middle
    alignas(64) PerFan parent_x, parent_y, parent_z;  // that removed faces meet in
    alignas(64) PerFan parent_place;
  };
  [[nodiscard]] const Corners& corners() const noexcept { return corners_; }
  [[nodiscard]] std::size_t corner_count() const noexcept { return corner_count_; }  // of each fan

 private:
  Corners corners_{};
  std::size_t size_ = 0, corner_count_ = 0;
};

}  // namespace occlod
