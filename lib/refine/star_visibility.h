// Stars that are one fan, many looked at together from one eye: a star to a lane.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/hierarchy.h"
#include "occlod/view.h"
#include "splits/star.h"

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
    static constexpr std::size_t max_places = SplitStar::max_ring + 1;
    alignas(64) std::array<PerFan<float>, max_places> x, y, z;  // of the ring
    alignas(64) PerFan<float> vertex_x, vertex_y, vertex_z;     // in the middle
    alignas(64) PerFan<float> parent_x, parent_y, parent_z;     // that removed faces meet in
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

// The few faces that one split removes and inserts, looked at from one eye.

struct StarView {
  float visible_share = 0.0F;  // of the faces, those that face the eye and are not outside the frustum; in [0, 1]
  float cosine = 1.0F;         // between the eye's rays and the normals of these, their mean by area; 1 = head-on
  float scale_px = 0.0F;       // ObjectView::largest_scale_px() of the sphere
  Sphere sphere;               // around all corners
};

// True only when every point of the sphere is inside the frustum.
[[nodiscard]] bool is_wholly_inside(const Sphere& sphere, const ObjectView& view);

// Reuses its memory.
class StarVisibility {
 public:
  // `two_sided`: back faces count as facing the eye.
  [[nodiscard]] StarView evaluate(const Hierarchy& hierarchy, SplitId s, const ObjectView& view, bool two_sided) {
    StarView star;
    evaluate(hierarchy, {&s, 1}, view, two_sided, {&star, 1});
    return star;
  }
  // The same of many splits, which costs less than one by one.
  void evaluate(const Hierarchy& hierarchy, std::span<const SplitId> splits, const ObjectView& view, bool two_sided,
                std::span<StarView> stars);

  // The corners of the star of s, each once, the vertex that it brings back first: what an occlusion query asks about.
  // Valid until the next call of any function.
  [[nodiscard]] std::span<const glm::vec3> points(const Hierarchy& hierarchy, SplitId s) {
    points_.clear();
    append_points(hierarchy, s, points_);
    return points_;
  }
  // The same, after what is there.
  static void append_points(const Hierarchy& hierarchy, SplitId s, std::vector<glm::vec3>& points);

 private:
  [[nodiscard]] StarView evaluate_faces(const Hierarchy& hierarchy, SplitId s, const ObjectView& view, bool two_sided);

  FanBatch fans_;
  std::vector<glm::vec3> points_;
};

}  // namespace occlod
