// Implements occlod render --path: every frame of a camera path, one after the other.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "base/atomic_file.h"
#include "measurement.h"
#include "occlod/device.h"
#include "occlod/picture.h"
#include "occlod/refiner.h"
#include "refine_way.h"
#include "render_input.h"

namespace occlod::tool {

struct PathOutput {
  std::string png;  // frame i of view.png becomes view_0000i.png; empty: no pictures
  Following following = Following::none;
  int repeat = 1;  // 1 when following
  bool json = false;
  bool explain = false;
  std::span<const ObjectTexture> textures = {};   // of the pictures; one per object, or empty
  std::span<const hlod::PlacedHlod> beside = {};  // HLODs of the scene to compare with at the end, unless empty
  FileGroup* files = nullptr;                     // committed after the last frame
};

// Refines the frames camera_at(*input.path, frame) with one Refiner, and prints the results of each: a table for
// people, or one JSON object with an array `frames`.
void render_path(const RenderInput& input, const RefineOptions& options, RefineWay& way, const PathOutput& output);

// Maps "folder/view.png", 7 to "folder/view_00007.png": five digits, more where a frame needs them.
[[nodiscard]] std::filesystem::path numbered(const std::filesystem::path& file, int frame);

}  // namespace occlod::tool
