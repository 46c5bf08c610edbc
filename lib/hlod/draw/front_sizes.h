// Forecasts how many triangles a front has, for any tolerance.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "hlod/draw/frame_scene.h"
#include "occlod/device.h"
#include "occlod/view.h"

namespace occlod::hlod {

// The triangles inside the frustum of one view, hidden or not: a patch is drawn at tolerances from its node's error up
// to that of the parent that it belongs to.
class FrontSizes {
 public:
  // Looks at all nodes that may be drawn at tolerances of at least `least_px`. O(nodes + those * log(those)).
  void assign(const View& view, std::span<const PlacedHlod> objects, double least_px);

  // Returns how many triangles are drawn at this tolerance.
  [[nodiscard]] double at(double tolerance_px) const;
  // Returns about the least tolerance above another one at which no more triangles are drawn, or coarsest_px() if there
  // is none: a little larger where that makes no difference, so that it holds for a view from nearby too.
  [[nodiscard]] double tolerance_px(double triangles, double above_px = -1.0) const;
  // Returns the least tolerance at which nothing is refined.
  [[nodiscard]] double coarsest_px() const { return steps_.back().from_px; }

 private:
  struct Step {
    double from_px = 0.0;
    double triangles = 0.0;  // drawn from there on up to the next step; before they are added up: how many more
  };

  void add(const PlacedHlod& object, const View& view, double least_px);

  std::vector<Step> steps_;  // ascending, the first at least_px
  // By node of an object; scratch memory.
  std::vector<bool> is_reached_;
  std::vector<double> refined_px_;  // it is refined at smaller tolerances
};

}  // namespace occlod::hlod
