// The backend `software`: a CPU depth raster and a depth pyramid. No GPU, no display, no driver.
#pragma once

#include <memory>

#include "occlod/refine/visibility.h"

namespace occlod {

// How the software backend answers.
struct SoftwareOcclusionOptions {
  bool count_pixels = false;  // answer with the number of visible pixels that the bound may touch instead of 0 or 1
};

// Works at the resolution of the view. A bound is hidden only if the occluder is strictly nearer than the bound's
// nearest point at every pixel that it may touch: those of an octagon around its outline, or of a rectangle for boxes.
// The same answers on every machine. Many queries in one answer() or submitted before the first is collected cost a
// third of the same queries asked one by one. A bound that lies beside the image touches no pixel and is answered 0;
// one whose screen rectangle cannot be bounded is visible (with count_pixels: all pixels). Until an occluder is drawn
// in a view, everything in the image is visible. Does not allocate once its buffers have grown.
[[nodiscard]] std::unique_ptr<Visibility> make_software_occlusion(const SoftwareOcclusionOptions& options = {});

}  // namespace occlod
