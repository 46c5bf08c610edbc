// Draws how a number went over the last pictures.
#pragma once

#include <deque>

#include "panels.h"
#include "timeline.h"

namespace occlod::viewer {

// Draws one step of the line for each of the last pictures that have a finite number, as many as there is room for,
// with the scale on the left. `step` is the width of a picture, in pixels of the window.
void draw_plot(ImDrawList& list, const Area& area, const std::deque<PictureRecord>& records, Plot plot, float step);

}  // namespace occlod::viewer
