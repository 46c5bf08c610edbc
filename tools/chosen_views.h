// The camera or the camera path that a command is asked for.
#pragma once

#include <optional>
#include <string>

#include "occlod/scene.h"
#include "occlod/view.h"
#include "world_box.h"

namespace CLI {
class App;
}

namespace occlod::tool {

struct ImageSize {
  int width = 0;
  int height = 0;
};

struct ViewOptions {
  std::string camera = "default";
  std::string path;               // instead of the camera
  std::optional<ImageSize> size;  // instead of the camera's own
  bool orthographic = false;      // instead of the camera's perspective, or of that of every key of a path
};

// "640x480"; nothing for anything else.
[[nodiscard]] std::optional<ImageSize> parse_size(const std::string& text);

// --size.
void add_size_option(CLI::App& command, ViewOptions& options);
// The same and --orthographic.
void add_size_options(CLI::App& command, ViewOptions& options);

// Of a scene file, as the options change them. Throw Error for a name that it does not have.
[[nodiscard]] Camera chosen_camera(const SceneDescription& scene, const ViewOptions& options);
[[nodiscard]] CameraPath chosen_path(const SceneDescription& scene, const ViewOptions& options);

// For what comes without cameras: looks at the sphere around the box, from a little above and to the right, as near as
// shows all of it.
[[nodiscard]] Camera camera_that_sees(const WorldBox& box, const ViewOptions& options);

}  // namespace occlod::tool
