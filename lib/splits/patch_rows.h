// Spheres and cones of patches, and how far they reach from the middles of nodes, many at once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>

#include "base/large_vector.h"
#include "splits/star_patch.h"

namespace occlod {

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

}  // namespace occlod
