// Views of a scene beside its default camera: frames of its paths and random ones.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/arithmetic.h"
#include "visibility/scene_run.h"

namespace occlod::bench {

struct NamedView {
  std::string name;  // of a camera, path and frame ("walk 40") or number of a random one ("random 17")
  Camera camera;
};

// Makes random cameras: eyes from close above the surface to where all of it is seen, looking at the surface; where the
// scene has a path "walk", every other one has its eye on that and looks anywhere. The same seed and scene give the
// same cameras.
class RandomCameras {
 public:
  RandomCameras(const SceneRun& run, const std::optional<tool::ImageSize>& size, std::uint64_t seed);
  [[nodiscard]] Camera next();

 private:
  [[nodiscard]] glm::dvec3 direction();
  [[nodiscard]] glm::dvec3 surface_point();
  [[nodiscard]] Camera on_walk(const CameraPath& walk);
  [[nodiscard]] Camera near_surface();

  const SceneRun& run_;
  std::optional<tool::ImageSize> size_;
  RandomStream random_;
  glm::dvec3 middle_{0.0};
  double radius_ = 1.0;      // of the sphere around the boxes of all objects
  bool is_walking_ = false;  // in the camera made last
};

[[nodiscard]] Camera sized(Camera camera, const std::optional<tool::ImageSize>& size);

// Frames of all paths, at most `most` of each: spread evenly over those that move, one for each key of those that jump.
[[nodiscard]] std::vector<NamedView> path_views(const SceneRun& run, int most,
                                                const std::optional<tool::ImageSize>& size);

// Whether a picture shows enough of the scene, and its front sides: from within a solid one sees the backs of faces
// that are not two-sided, which culling takes as unseen.
[[nodiscard]] bool is_fair(const SceneRun& run, const View& view, const ItemBuffer& items,
                           std::span<const DrawObject> drawn);

}  // namespace occlod::bench
