// The cull map of Chhugani and others 2003, sec. 5.1: what occluders that stand on the ground hide from a cell, as a
// height for each place on the ground.
#pragma once

#include <vector>

#include "papers/convex_occluder.h"

namespace occlod::paper {

// A square grid over the ground plan of a scene. Heights are those below which all of a pixel is hidden.
class CullMap {
 public:
  // `pixels` along each side.
  CullMap(const CellBox& scene, int pixels);

  // Shadows are fused: the highest counts. A pixel counts where the shadow covers all of it from the ground on.
  void add(const ShadowFrustum& frustum);
  // Whether all pixels that the ground plan of the box touches are higher than its top.
  [[nodiscard]] bool hides(const CellBox& what) const;

 private:
  [[nodiscard]] double height(const ShadowFrustum& frustum, double x, double y) const;

  CellBox scene_;
  int pixels_;
  std::vector<double> heights_;  // row by row
};

}  // namespace occlod::paper
