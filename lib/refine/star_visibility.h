// Finds how the faces that a split removes and inserts are seen from one eye.
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

// Holds the corners of a few stars that are fans, to look at them together: one star per lane.
class FanBatch {
 public:
  static constexpr std::size_t capacity = 16;  // number of fans
  template <class T>
  using PerFan = std::array<T, capacity>;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  void clear() noexcept {
    size_ = 0;
    longest_ = 0;
  }
  // Adds the star of a split. Precondition: it is a fan, and there is room.
  void add(const SplitStar& star, std::span<const glm::vec3> positions);

  // Holds the input of find_fan_views(). Places beyond a ring repeat its first vertex.
  struct Corners {
    static constexpr std::size_t max_places = SplitStar::max_ring + 1;
    alignas(64) std::array<PerFan<float>, max_places> x, y, z;  // vertices of the ring
    alignas(64) PerFan<float> vertex_x, vertex_y, vertex_z;     // vertex in the middle
    alignas(64) PerFan<float> parent_x, parent_y, parent_z;     // vertex in which removed faces meet
    alignas(64) PerFan<float> inserted, parent_place, place_before_parent;
  };
  [[nodiscard]] const Corners& corners() const noexcept { return corners_; }
  // Returns the size of the largest ring.
  [[nodiscard]] std::size_t longest() const noexcept { return longest_; }

 private:
  Corners corners_{};
  std::size_t size_ = 0, longest_ = 0;
};

// Holds what is seen of each fan. Sums are over inserted and removed faces that face the eye, in turn along the ring.
struct FanViews {
  template <class T>
  using PerFan = FanBatch::PerFan<T>;

  alignas(64) PerFan<float> center_x, center_y, center_z, radius;  // sphere around all corners
  alignas(
      64) PerFan<float> room_inside;   // distance from the sphere to the nearest plane of the frustum, < 0 if crossed
  alignas(64) PerFan<float> faces;     // number of faces
  alignas(64) PerFan<float> whole;     // twice the sum of their areas
  alignas(64) PerFan<float> facing;    // twice the sum of their areas as seen from the eye
  alignas(64) PerFan<float> scale_px;  // ObjectView::largest_scale_px() of the sphere

  [[nodiscard]] Sphere sphere(std::size_t i) const { return {{center_x[i], center_y[i], center_z[i]}, radius[i]}; }
};

// Finds the views of all fans: the same bits with every instruction set and whatever else is in the batch.
void find_fan_views(const FanBatch& batch, const ObjectView& view, bool two_sided, FanViews& views);

// Describes how the faces of a star are seen.
struct StarView {
  float visible_share = 0.0F;  // share of the faces that face the eye and are not outside the frustum, in [0, 1]
  float cosine = 1.0F;         // mean cosine by area between the eye's rays and the normals of these; 1 = head-on
  float scale_px = 0.0F;       // ObjectView::largest_scale_px() of the sphere
  Sphere sphere;               // sphere around all corners
};

// Returns true only when every point of the sphere is inside the frustum.
[[nodiscard]] bool is_wholly_inside(const Sphere& sphere, const ObjectView& view);

// Evaluates the stars of splits. Reuses its memory.
class StarVisibility {
 public:
  // Returns how the star of s is seen. `two_sided`: back faces count as facing the eye.
  [[nodiscard]] StarView evaluate(const Hierarchy& hierarchy, SplitId s, const ObjectView& view, bool two_sided) {
    StarView star;
    evaluate(hierarchy, {&s, 1}, view, two_sided, {&star, 1});
    return star;
  }
  // Evaluates many splits, which costs less than one by one.
  void evaluate(const Hierarchy& hierarchy, std::span<const SplitId> splits, const ObjectView& view, bool two_sided,
                std::span<StarView> stars);

  // Returns the corners of the star of s, each once, first the vertex that it brings back: what an occlusion query asks
  // about. Valid until the next call of any function.
  [[nodiscard]] std::span<const glm::vec3> points(const Hierarchy& hierarchy, SplitId s) {
    points_.clear();
    append_points(hierarchy, s, points_);
    return points_;
  }
  // Appends the same corners to `points`.
  static void append_points(const Hierarchy& hierarchy, SplitId s, std::vector<glm::vec3>& points);

 private:
  [[nodiscard]] StarView evaluate_faces(const Hierarchy& hierarchy, SplitId s, const ObjectView& view, bool two_sided);

  FanBatch fans_;
  std::vector<glm::vec3> points_;
};

}  // namespace occlod
