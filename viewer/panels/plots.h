// Draws how a number went over the last pictures.
#pragma once

#include <deque>

#include "panels.h"
#include "timeline.h"

namespace occlod::viewer {

// Draws lines where whole seconds have passed between the pictures from `first` on, the last of which ends at the right
// of the area, and writes below it how many seconds. `step` is the width of a picture, in pixels of the window.
void draw_time_axis(ImDrawList& list, const Area& area, const std::deque<PictureRecord>& records, std::size_t first,
                    float step);

// Draws one step of the line for each of the last pictures that have a finite number, as many as there is room for,
// with the scale on the left. There is a record.
void draw_plot(ImDrawList& list, const Area& area, const std::deque<PictureRecord>& records, Plot plot, float step);

}  // namespace occlod::viewer
