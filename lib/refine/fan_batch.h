// Stars that are one fan, many looked at together from one eye: a star to a lane.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "occlod/hierarchy/split_star.h"
#include "occlod/view/view.h"

namespace occlod {

// The corners of a few fans.
class FanBatch {
 public:
  static constexpr std::size_t capacity = 16;  // fans
  template <class T>
  using PerFan = std::array<T, capacity>;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  void clear() noexcept {
    size_ = 0;
    longest_ = 0;
  }
  // Another one, of this split. Precondition: it is a fan, and there is room.
  void add(const SplitStar& star, std::span<const glm::vec3> positions);

  // For find_fan_views(). Places beyond a ring repeat it from its first vertex on.
  struct Corners {
    static constexpr std::size_t most_places = SplitStar::most_ring + 1;
    alignas(64) std::array<PerFan<float>, most_places> x, y, z;  // of the ring
    alignas(64) PerFan<float> vertex_x, vertex_y, vertex_z;      // in the middle
    alignas(64) PerFan<float> parent_x, parent_y, parent_z;      // that removed faces meet in
    alignas(64) PerFan<float> inserted, parent_place, place_before_parent;
  };
  [[nodiscard]] const Corners& corners() const noexcept { return corners_; }
  // The size of the largest ring among them.
  [[nodiscard]] std::size_t longest() const noexcept { return longest_; }

 private:
  Corners corners_{};
  std::size_t size_ = 0, longest_ = 0;
};

// What is seen of each fan. Sums are over inserted and removed faces that face the eye, in turn along the ring.
struct FanViews {
  template <class T>
  using PerFan = FanBatch::PerFan<T>;

  alignas(64) PerFan<float> center_x, center_y, center_z, radius;  // of a sphere around all corners
  alignas(
      64) PerFan<float> room_inside;   // that the sphere has to the nearest plane of the frustum; negative: crosses it
  alignas(64) PerFan<float> faces;     // how many
  alignas(64) PerFan<float> whole;     // twice their areas
  alignas(64) PerFan<float> facing;    // of the parts of these that face the eye
  alignas(64) PerFan<float> scale_px;  // ObjectView::largest_scale_px() of the sphere

  [[nodiscard]] Sphere sphere(std::size_t i) const { return {{center_x[i], center_y[i], center_z[i]}, radius[i]}; }
};

// The same bits with every instruction set and whatever else is in the batch.
void find_fan_views(const FanBatch& batch, const ObjectView& view, bool two_sided, FanViews& views);

}  // namespace occlod
