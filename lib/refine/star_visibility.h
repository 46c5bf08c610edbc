// The few faces that one split removes and inserts, looked at from one eye.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/view/view.h"
#include "refine/fan_batch.h"

namespace occlod {

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
