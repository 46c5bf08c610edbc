// Makes lines that explain: the frustum, and the picked split's bounds, normals and faces.
#pragma once

#include <vector>

#include "lines.h"
#include "session.h"

namespace occlod::viewer {

// Returns the lines over the mesh in the main view, or in one half of the split screen.
[[nodiscard]] std::vector<Line> main_overlay(const Session& session, std::size_t side = 0);
// Returns the frustum for which is refined, as far as the scene reaches, and the camera paths.
[[nodiscard]] std::vector<Line> birdseye_overlay(const Session& session);
// Returns a camera that shows the scene and the refined camera's eye from above.
[[nodiscard]] Camera birdseye_camera(const Session& session, int width, int height);

}  // namespace occlod::viewer
