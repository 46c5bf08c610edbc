// A picture of the nodes that a frame has drawn, seen from outside.
#pragma once

#include <span>

#include "front_mesh.h"
#include "occlod/picture.h"
#include "occlod/view.h"

namespace occlod::tool {

// Nodes and their boxes from above, with the frustum of the view that the frame was drawn for: blue where their errors
// counted in full, over magenta to red where only a small part of them was visible (Charalambos 2006, figs 8 to 10).
[[nodiscard]] Image picture_of_boxes(const Front& front, std::span<const hlod::PlacedHlod> placed, const View& view);

}  // namespace occlod::tool
