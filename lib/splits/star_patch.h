// What the own faces of one split occupy.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>

#include "base/memory.h"
#include "occlod/base.h"
#include "occlod/bounds.h"
#include "occlod/hierarchy.h"

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

// Spheres and cones of patches, and how far they reach from the middles of nodes, many at once.

// One row for each number of a patch.
class PatchRows {
 public:
  static constexpr std::size_t padding = 16;  // places that may be read behind the last
  enum Row : std::uint8_t { x, y, z, radius, axis_x, axis_y, axis_z, cos_angle, sin_angle, row_count };

  // Not initialised, but for the padding.
  explicit PatchRows(std::size_t size);

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] const float* row(Row row) const noexcept { return values_.get() + row * stride_; }
  void set(std::size_t i, const Patch& patch) noexcept;
  [[nodiscard]] Patch operator[](std::size_t i) const noexcept;

  static constexpr float no_normal = 2.0F;  // cos_angle of a patch without one

 private:
  struct Delete {
    std::size_t bytes;
    void operator()(float* values) const noexcept { free_large(values, bytes); }
  };

  std::size_t size_, stride_;
  std::unique_ptr<float, Delete> values_;
};

// Nodes whose patches begin one after the other.
struct NodeExtents {
  static constexpr std::size_t capacity = 16;
  template <class T>
  using PerNode = std::array<T, capacity>;

  // Given: the middle of the node, the axis of its cone and of its cylinder, its number of patches.
  alignas(64) PerNode<float> center_x, center_y, center_z, axis_x, axis_y, axis_z;
  alignas(64) PerNode<std::int32_t> size;
  // Wanted: of a sphere and of a cylinder around the middle; of a cone, at most 0 without one.
  alignas(64) PerNode<float> radius, cylinder_radius, t_min, t_max, cos_angle;
  alignas(64) PerNode<std::int32_t> has_normal;
  // Squares of lengths left the range of floats; the results are to be computed otherwise.
  alignas(64) PerNode<std::int32_t> is_extreme;

  void start(std::size_t node, const glm::vec3& center, const glm::vec3& axis);
};

// Includes the patches [first + i, first + i + size[i]) in node i. All nodes are smaller than NodeExtents::capacity or
// empty. The same bits with every instruction set.
void include_patches(const PatchRows& patches, std::size_t first, NodeExtents& nodes);

// Includes the patches [first, end) in one node.
void include_run(const PatchRows& patches, std::size_t first, std::size_t end, NodeExtents& nodes, std::size_t node);

// A cone around `axis` that holds the patch's cone, by the cosine of its angle; -1 when that is a half space or more.
[[nodiscard]] float widened(const glm::vec3& axis, const Patch& patch);

// What the own faces of many splits occupy: those of bound_star(), a closed fan to a lane.

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
  static constexpr std::size_t max_corners = 24;

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
    alignas(64) std::array<PerFan, max_corners> x, y, z;
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
