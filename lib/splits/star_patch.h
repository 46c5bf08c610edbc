// Bounds the own faces of splits, and the normals of runs of them.
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
#include "splits/star.h"

namespace occlod {

// Bounds the normals of the faces of one split, or of a run of splits, by a cone.
struct Patch {
  glm::vec3 axis{0.0F};
  float cos_angle = 1.0F;  // of the half angle; -1 = every direction
  float sin_angle = 0.0F;
  bool has_normal = false;  // false: all faces are degenerate, so they cover no pixel and have no direction
};

struct BoundedPatch {
  Patch patch;
  Box box;
};

// Bounds the faces that the split inserts and removes.
[[nodiscard]] BoundedPatch bound_star(const SplitStar& star, std::span<const glm::vec3> positions);

// Keeps cones conservative under rounding.
inline constexpr float cone_slack = 4e-6F;
// A corner whose squared sine is at most this needs double precision; for any other, single precision gives the normal
// to within normal_slack.
inline constexpr float min_sin2 = 0.0025F;
inline constexpr float normal_slack = 1e-5F;

// Computes, for many patches at once, how far their cones reach from the axes of nodes.

// Stores one row per number of a patch.
class PatchRows {
 public:
  static constexpr std::size_t padding = 16;  // places that may be read past the end
  enum Row : std::uint8_t { axis_x, axis_y, axis_z, cos_angle, sin_angle, row_count };

  // Leaves the rows uninitialised, except for the padding.
  explicit PatchRows(std::size_t size);

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] const float* row(Row row) const noexcept { return values_.get() + row * stride_; }
  void set(std::size_t i, const Patch& patch) noexcept;
  [[nodiscard]] Patch operator[](std::size_t i) const noexcept;

  static constexpr float no_normal = 2.0F;  // cos_angle of a patch without a normal

 private:
  struct Delete {
    std::size_t bytes;
    void operator()(float* values) const noexcept { free_large(values, bytes); }
  };

  std::size_t size_, stride_;
  std::unique_ptr<float, Delete> values_;
};

// Holds nodes whose patches are stored one after the other.
struct NodeExtents {
  static constexpr std::size_t capacity = 16;
  template <class T>
  using PerNode = std::array<T, capacity>;

  // Input: the axis of the node's cone, its number of patches.
  alignas(64) PerNode<float> axis_x, axis_y, axis_z;
  alignas(64) PerNode<std::int32_t> size;
  // Output: the cosine of the angle of the cone, at most 0 without a cone.
  alignas(64) PerNode<float> cos_angle;
  alignas(64) PerNode<std::int32_t> has_normal;

  void start(std::size_t node, const glm::vec3& axis);
};

// Includes the patches [first + i, first + i + size[i]) in node i. All nodes are smaller than NodeExtents::capacity or
// empty. The bits are the same with every instruction set.
void include_patches(const PatchRows& patches, std::size_t first, NodeExtents& nodes);

// Includes the patches [first, end) in one node.
void include_run(const PatchRows& patches, std::size_t first, std::size_t end, NodeExtents& nodes, std::size_t node);

// Returns the cosine of the angle of a cone around `axis` that contains the patch's cone; -1 when that is a half space
// or more.
[[nodiscard]] float widened(const glm::vec3& axis, const Patch& patch);

// Bounds the own faces of many splits as bound_star() does, with one closed fan per SIMD lane.

// Holds the result of bound_star() for each fan.
struct FanPatchBounds {
  static constexpr std::size_t capacity = 16;  // number of fans
  using PerFan = std::array<float, capacity>;

  alignas(64) PerFan min_x, min_y, min_z, max_x, max_y, max_z;
  alignas(64) PerFan axis_x, axis_y, axis_z, cos_angle, sin_angle;
  alignas(64) PerFan is_bounded;  // 0: use bound_star(), because there are slivers or extreme lengths

  [[nodiscard]] BoundedPatch operator[](std::size_t i) const noexcept;
};

// Collects closed fans with equally many corners.
class FanPatches {
 public:
  static constexpr std::size_t capacity = FanPatchBounds::capacity;
  static constexpr std::size_t max_corners = 24;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  void clear() noexcept { size_ = 0; }
  // Adds the fan of the split that restores v beside the corner `parent`. Precondition: there is room, and it has as
  // many corners as the others.
  void add(VertexId v, std::span<const VertexId> ring, VertexId parent, std::span<const glm::vec3> positions);

  // Returns the bounds. The bits are the same with every instruction set and do not depend on the other fans.
  [[nodiscard]] FanPatchBounds bounds() const;

  // Input of bounds(): corners in ring order.
  struct Corners {
    using PerFan = FanPatchBounds::PerFan;
    alignas(64) std::array<PerFan, max_corners> x, y, z;
    alignas(64) PerFan vertex_x, vertex_y, vertex_z;  // the centre of the fan
    alignas(64) PerFan parent_x, parent_y, parent_z;  // the apex of the removed faces
    alignas(64) PerFan parent_place;
  };
  [[nodiscard]] const Corners& corners() const noexcept { return corners_; }
  [[nodiscard]] std::size_t corner_count() const noexcept { return corner_count_; }  // per fan

 private:
  Corners corners_{};
  std::size_t size_ = 0, corner_count_ = 0;
};

}  // namespace occlod
