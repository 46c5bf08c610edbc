// The backend `software`: a CPU depth raster and a depth pyramid. No GPU, no display, no driver.
#pragma once

#include <memory>

#include "occlod/refine/visibility.h"

namespace occlod {

struct SoftwareOcclusionOptions {
  bool count_pixels = false;  // answer with the number of visible pixels that the bound may touch instead of 0 or 1
};

// Occluder and tests at the view's own resolution. A bound is hidden only if the occluder is strictly nearer than the
// bound's nearest point at every pixel that it touches: those of an octagon around its outline, of a rectangle for
// boxes. The same answers on every machine; many queries submitted before the first is collected cost a third of as
// many asked one by one. A bound whose whole rectangle lies beside the image
// touches no pixel and is answered 0; one that no rectangle can be trusted for is visible (with count_pixels: all
// pixels). Until an occluder is drawn in a view, every pixel is visible. Does not allocate in a steady state.
[[nodiscard]] std::unique_ptr<Visibility> make_software_occlusion(const SoftwareOcclusionOptions& options = {});

}  // namespace occlod
