// Draws the legend of colours into a picture that is written without the panels.
#pragma once

#include <span>

#include "occlod/picture.h"
#include "palette.h"

namespace occlod::viewer {

// Draws it in the lower left corner, with the font of the panels. `scale` is theirs. Returns false where the picture
// has no room for it, which stays as it is.
bool draw_legend(Image& image, std::span<const LegendEntry> legend, float scale);

}  // namespace occlod::viewer
