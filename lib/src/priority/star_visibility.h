// The few faces that one split removes and inserts, looked at from one eye.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/view/view.h"
#include "priority/fan_visibility.h"

namespace occlod {

struct StarView {
  float visible_share = 0.0F;  // of the faces, those that face the eye and are not outside the frustum; in [0, 1]
  float cosine = 1.0F;         // between the eye's rays and the normals of these, their mean by area; 1 = head-on
  Sphere sphere;               // around all corners
};

// True only when every point of the sphere is inside the frustum.
[[nodiscard]] bool is_wholly_inside(const Sphere& sphere, const ObjectView& view);

// Reuses its memory.
class StarVisibility {
 public:
  // `two_sided`: back faces count as facing the eye.
  [[nodiscard]] StarView evaluate(const Hierarchy& hierarchy, SplitId s, const ObjectView& view, bool two_sided);
  // The corners of the star of s, each once: what an occlusion query asks about.
  [[nodiscard]] std::span<const glm::vec3> points(const Hierarchy& hierarchy, SplitId s);

 private:
  void gather(const Hierarchy& hierarchy, SplitId s);
  void gather_corners(const SplitStar& star);
  void gather_fan(const Hierarchy& hierarchy, const SplitStar& star);

  std::vector<VertexId> ids_;
  std::vector<glm::vec3> points_;
  FanCorners fan_;
};

}  // namespace occlod
