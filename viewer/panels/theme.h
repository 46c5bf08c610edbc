// Sets fonts, colours and distances of the panels.
#pragma once

#include <imgui.h>

#include "settings.h"

namespace occlod::viewer {

// Applies them for text and panels of this scale, where 1 is 96 dots per inch. It replaces the fonts, so call it only
// between two pictures.
void apply_theme(float scale, Theme theme);

// Colours of text that stand out from the panels of the theme.
[[nodiscard]] ImVec4 accent_color();
[[nodiscard]] ImVec4 error_color_of_text();

}  // namespace occlod::viewer
