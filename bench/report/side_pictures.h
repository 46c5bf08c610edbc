// Parts of pictures that show what settings get wrong.
#pragma once

#include <string>
#include <vector>

#include "occlod/picture.h"
#include "report/settings.h"
#include "report/sweep.h"

namespace occlod::bench {

struct SidePictures {
  int frame = 0;
  Image full;                  // from the full mesh
  std::vector<Image> refined;  // with each of the settings
};

// The last frame of the burst in the middle, shaded without wire: the part of that size, pixel for pixel, where the
// first of the settings, at least one, differs most from the full mesh.
[[nodiscard]] SidePictures draw_beside(const SceneRun& run, const std::string& path,
                                       const std::vector<Setting>& settings, const SweepOptions& options,
                                       const tool::ImageSize& part);

}  // namespace occlod::bench
