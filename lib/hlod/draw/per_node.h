// What a strategy remembers of nodes.
#pragma once

#include <vector>

#include "hlod/draw/frame_scene.h"

namespace occlod::hlod {

template <typename T>
class PerNode {
 public:
  // Before the first use in a frame. Forgets everything in the first frame of the scene. Whether nothing is known.
  bool fit(const FrameScene& scene) {
    if (scene.frame() > 1 && !values_.empty()) return false;
    values_.resize(scene.object_count());
    for (std::uint32_t i = 0; i < scene.object_count(); ++i) values_[i].assign(scene.hlod({i, 0}).node_count(), T());
    return true;
  }
  [[nodiscard]] T& operator[](NodeRef n) noexcept { return values_[n.object][n.node]; }
  [[nodiscard]] const T& operator[](NodeRef n) const noexcept { return values_[n.object][n.node]; }

 private:
  std::vector<std::vector<T>> values_;
};

}  // namespace occlod::hlod
