// Holds the arrays of a hierarchy during building.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <vector>

#include "base/memory.h"
#include "occlod/hierarchy.h"

namespace occlod {

// Owns the arrays that a HierarchyView refers to.
struct HierarchyData {
  UninitializedVector<glm::vec3> positions;
  UninitializedVector<glm::vec3> normals;
  UninitializedVector<glm::u8vec4> colors;
  UninitializedVector<SplitNode> nodes;
  UninitializedVector<std::uint32_t> stars;
  UninitializedVector<SplitId> roots;
  UninitializedVector<Triangle> base_faces;
  Box box;
  std::uint64_t input_triangle_count = 0;
  std::uint64_t face_count = 0;
  float error_bound = 0.0F;
  UninitializedVector<glm::vec2> texture_coordinates;
  UninitializedVector<VertexId> extra_wedges;
  UninitializedVector<MaterialId> wedge_materials;
  UninitializedVector<std::uint32_t> corners;
  UninitializedVector<std::uint32_t> corner_starts;
  UninitializedVector<Triangle> base_corners;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  UninitializedVector<std::uint16_t> attribute_errors;
  TextureOrigin texture_origin = TextureOrigin::bottom_left;
  glm::dvec3 origin{0.0};
  UpAxis up = UpAxis::z;
};

[[nodiscard]] HierarchyView view_of(const HierarchyData& data);
// Makes a hierarchy from arrays whose sizes and indices are consistent.
[[nodiscard]] Hierarchy make_hierarchy(HierarchyData data);
[[nodiscard]] HierarchyData copy_data(const Hierarchy& hierarchy);

// Lets a hierarchy be used before all of it has been read: each block of splits is checked when it is first needed.

// Checks blocks, which are runs of splits. Thread-safe.
class SplitGuard {
 public:
  static constexpr std::uint32_t block_bits = 10;
  static constexpr std::size_t block_size = std::size_t{1} << block_bits;

  explicit SplitGuard(std::size_t split_count) : checked_((split_count + block_size - 1) / block_size) {}
  SplitGuard(const SplitGuard&) = delete;
  SplitGuard& operator=(const SplitGuard&) = delete;
  virtual ~SplitGuard() = default;

  // Marks the block as checked, or throws Error when it is damaged.
  void check(std::size_t block) {
    check_block(block);
    checked_[block].store(true, std::memory_order_release);
  }

  [[nodiscard]] std::size_t block_count() const noexcept { return checked_.size(); }
  // Returns one flag per block; a thread that has seen the flag set may use the block's data.
  [[nodiscard]] const std::atomic<bool>* checked() const noexcept { return checked_.data(); }

 private:
  virtual void check_block(std::size_t block) = 0;

  std::vector<std::atomic<bool>> checked_;
};

// Makes a hierarchy from arrays that `owner` keeps alive and of which `guard` checks each block before its first use.
[[nodiscard]] Hierarchy guarded_hierarchy(const HierarchyView& view, std::shared_ptr<const void> owner,
                                          std::shared_ptr<SplitGuard> guard);

}  // namespace occlod
