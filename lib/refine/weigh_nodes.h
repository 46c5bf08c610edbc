// How large an object unit is on the screen at nodes of a front, and for how long that is so.
#pragma once

#include <span>

#include "occlod/view/view.h"
#include "refine/front.h"
#include "refine/view_motion.h"

namespace occlod {

struct WeighingView {
  const ObjectView& view;
  bool tests_cones = true;  // whether nodes may face away
  ViewMotion motion;        // so far
  glm::vec3 center{0.0F};   // that it is counted from
};

// Finds anew for these nodes: Front::scales(), what largest_scale_px() of the view tells; whether they are outside or
// face away, as flags. Many at once, the same on every instruction set.
void weigh_nodes(Front& front, std::span<const Front::Index> which, const WeighingView& now);

}  // namespace occlod
