// Sets fonts, colours and distances of the panels.
#pragma once

namespace occlod::viewer {

// Applies them for text and panels of this scale, where 1 is 96 dots per inch. It replaces the fonts, so call it only
// between two pictures.
void apply_theme(float scale);

}  // namespace occlod::viewer
