// Checks that every frame of a camera path has a view.
#pragma once

#include <optional>
#include <string>

#include "occlod/base.h"
#include "occlod/scene.h"

namespace occlod {

struct BadFrame {
  int frame = 0;  // numbered from 0
  int frames = 0;
  Diagnosis problem;  // as reported by View

  static constexpr const char* remedy =
      "add a key that leads the path around its target and the up direction, give it another number of frames, or set "
      "\"jump\": true";
  // Returns a message such as "makes no view in frame 2 of 5, numbered from 0: target is where the eye is".
  [[nodiscard]] std::string text() const;
};

// Returns the first frame from whose camera no View can be made, for a path with valid keys: one whose eye is on its
// target or whose up direction is along the line of sight. The time does not depend on the number of frames, except for
// parts of a path that come very near to such a camera.
[[nodiscard]] std::optional<BadFrame> find_bad_frame(const CameraPath& path);

}  // namespace occlod
