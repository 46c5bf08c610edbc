// Declares the options of `occlod render`.
#pragma once

#include <string>
#include <vector>

#include "backend.h"
#include "object_textures.h"
#include "occlod/refiner.h"
#include "refine_way.h"
#include "render_input.h"

namespace CLI {
class App;
}

namespace occlod::tool {

struct RenderOptions {
  RenderInputOptions input;
  RefineOptions refine;
  BackendOptions backend;  // `occlusion` is empty if it is not given
  AutoWayOptions auto_way;
  bool explain = false;
  std::string png;
  std::string birdseye;
  std::string mesh;
  TextureChoice texture = TextureChoice::automatic;  // in png and reference
  bool reference = false;
  bool frame_to_frame = false;
  int repeat = 1;
  bool json = false;
};

// `options` must outlive the command.
void add_render_options(CLI::App& command, RenderOptions& options);

}  // namespace occlod::tool
