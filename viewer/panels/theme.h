// Fonts, colours and distances of the panels.
#pragma once

namespace occlod::viewer {

// For text and panels of this scale, 1 = 96 dots an inch. Replaces the fonts: between two pictures only.
void apply_theme(float scale);

}  // namespace occlod::viewer
