// The software backend with fewer samples than pixels, to see what the resolution of the occluder is worth.
#pragma once

#include <memory>

#include "occlod/visibility.h"

namespace occlod::bench {

// One sample for divisor x divisor pixels (rounded up). Not conservative: what shows only between two samples may be
// hidden. divisor >= 1; with 1 it is the backend `software`.
[[nodiscard]] std::unique_ptr<Visibility> make_coarse_occlusion(int divisor);

}  // namespace occlod::bench
