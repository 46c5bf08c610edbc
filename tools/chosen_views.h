// Chooses the camera or the camera path that a command is asked for.
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
  std::string path;               // replaces the camera
  std::optional<ImageSize> size;  // replaces the camera's own
  bool orthographic = false;      // replaces the perspective of the camera, or of all keys of a path
};

// Returns whether the frame is one of `compared`, spread evenly over all `frames`; all are if there are no more.
[[nodiscard]] bool is_compared(int frame, int compared, int frames);

// Parses "640x480". Returns nothing for other text.
[[nodiscard]] std::optional<ImageSize> parse_size(const std::string& text);

// Adds --size.
void add_size_option(CLI::App& command, ViewOptions& options);
// Adds --size and --orthographic.
void add_size_options(CLI::App& command, ViewOptions& options);

// These return a camera or path of a scene file, changed as the options say. They throw Error for an unknown name.
[[nodiscard]] Camera chosen_camera(const SceneDescription& scene, const ViewOptions& options);
[[nodiscard]] CameraPath chosen_path(const SceneDescription& scene, const ViewOptions& options);

// Returns a camera for objects without one: it looks at the sphere around the box from a little above and to the right,
// as near as shows the whole sphere.
[[nodiscard]] Camera camera_that_sees(const WorldBox& box, const ViewOptions& options);

}  // namespace occlod::tool
