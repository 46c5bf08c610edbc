// One object in one view: what traversal computes of a node from its bounds.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <optional>

#include "occlod/hlod/metric.h"
#include "occlod/traverse/traverser.h"
#include "occlod/view/view.h"

namespace occlod::hlod {

class ObjectFrame {
 public:
  ObjectFrame(const View& view, const PlacedHlod& placed, const TraverseOptions& options);

  [[nodiscard]] double error_px(const Node& node) const;
  // By which nodes are taken in turn: world units from the eye, or from the eye plane where rays are parallel.
  [[nodiscard]] double distance(const Box& box) const;
  // False only when no point of the box is inside the frustum.
  [[nodiscard]] bool may_be_inside(const Box& box) const;
  // Pixels that the node's box covers on an empty screen, as `alpha` counts them. Nothing where the box that devices
  // draw reaches the near plane or holds the eye: such nodes count as visible.
  [[nodiscard]] std::optional<double> box_pixels(const Node& node) const;

 private:
  [[nodiscard]] std::optional<double> outline_pixels(const Box& box) const;
  [[nodiscard]] double cube_pixels(const Node& node) const;

  ObjectView view_;
  ScreenScale scale_;
  glm::dmat4 to_clip_;
  glm::dvec4 depth_;     // dot product with (p, 1): distance from the eye plane, world units
  glm::dvec2 size_;      // of the image, pixels
  double volume_scale_;  // cubic world units per cubic object unit
  Metric metric_;
  Alpha alpha_;
};

}  // namespace occlod::hlod
