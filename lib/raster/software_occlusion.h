// The backend `software` as tests compare it with others.
#pragma once

#include <memory>

#include "occlod/visibility.h"

namespace occlod {

// As without an argument; with `count_pixels` it answers with the number of visible pixels that a bound may touch, or
// all pixels of the image where its screen rectangle cannot be bounded, instead of 0 or 1.
[[nodiscard]] std::unique_ptr<SoftwareOcclusion> make_software_occlusion(bool count_pixels);

}  // namespace occlod
