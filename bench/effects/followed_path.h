// What a way to go on from frame to frame is worth along a path.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "effects/scores.h"

namespace occlod::bench {

// Consecutive frames of a path, and pictures of the full meshes in some of them.
class FollowedPath {
 public:
  // The first `frames` of so many that 120 make the whole path.
  FollowedPath(const SceneRun& run, const CameraPath& path, int frames);

  // Follows the path once more, from its beginning, and adds the time of each frame; the errors when it is the first
  // time.
  void follow(const Refine& refine, Scores& scores);

 private:
  const SceneRun& run_;
  std::vector<View> views_;
  std::vector<std::size_t> compared_;  // indices of views, ascending
  std::vector<tool::FullMeshPicture> full_;
  std::vector<DrawObject> drawn_;
  ItemBuffer items_;
};

}  // namespace occlod::bench
