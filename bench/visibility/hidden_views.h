// The views in which wrongly hidden pixels are looked for.
#pragma once

#include <string>
#include <vector>

#include "visibility/scene_run.h"

namespace occlod::bench {

struct HiddenView {
  std::string source;  // "random 17", or path and frame: "walk 40"
  Camera camera;
};

// Makes random cameras. Where the scene has a path "walk": its eyes, looking anywhere; else eyes from close above the
// surface to where all of it is seen, looking at the surface. The same seed and scene give the same cameras.
class RandomCameras {
 public:
  RandomCameras(const SceneRun& run, const VisibilityOptions& options, std::uint64_t seed);
  [[nodiscard]] Camera next();

 private:
  [[nodiscard]] double between(double low, double high);
  [[nodiscard]] glm::dvec3 direction();
  [[nodiscard]] glm::dvec3 surface_point();
  [[nodiscard]] Camera on_walk(const CameraPath& walk);
  [[nodiscard]] Camera outside();

  const SceneRun& run_;
  tool::ImageSize size_;
  std::uint64_t state_;
  glm::dvec3 middle_{0.0};
  double radius_ = 1.0;  // of the sphere around the boxes of all objects
};

// Frames of all paths, at most so many of each and no camera twice in a row.
[[nodiscard]] std::vector<HiddenView> path_views(const SceneRun& run, const VisibilityOptions& options);

// Whether a picture shows enough of the scene, and its front sides: from within a solid one sees the backs of faces
// that are not two-sided, which culling takes as unseen.
[[nodiscard]] bool is_fair(const SceneRun& run, const View& view, const ItemBuffer& items,
                           std::span<const DrawObject> drawn);

}  // namespace occlod::bench
