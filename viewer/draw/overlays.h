// Lines that explain: the frustum, the picked split's bounds, normals and faces.
#pragma once

#include <vector>

#include "lines.h"
#include "session.h"

namespace occlod::viewer {

// What lies over the mesh in the main view, or in one half of the split screen.
[[nodiscard]] std::vector<Line> main_overlay(const Session& session, std::size_t side = 0);
// The frustum that is refined for, as far as the scene reaches, and the camera paths.
[[nodiscard]] std::vector<Line> birdseye_overlay(const Session& session);
// From above, so that the scene and the eye that is refined for are in it.
[[nodiscard]] Camera birdseye_camera(const Session& session, int width, int height);

}  // namespace occlod::viewer
