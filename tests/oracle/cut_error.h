// What a cut leaves undone, found by walking the whole forest instead of believing what refinement kept book of.
#pragma once

#include <span>

#include "occlod/refiner.h"
#include "occlod/view.h"
#include "occlod/visibility.h"

namespace occlod::oracle {

// In pixels, of splits that are not applied and of whose own faces the eye sees some: the largest error of each kind.
// Not those whose star the refined meshes hide, as `visibility` answers.
struct CutError {
  double quadric_px = 0.0;
  double guaranteed_px = 0.0;
};
[[nodiscard]] CutError cut_error(std::span<const RefineObject> objects, const Refinement& refinement, const View& view,
                                 Visibility& visibility);

}  // namespace occlod::oracle
