// One object in one view: what traversal computes of a node from its bounds.
#pragma once

#include <glm/vec4.hpp>
#include <optional>

#include "hlod/draw/box_proxy.h"
#include "occlod/hlod/metric.h"
#include "occlod/traverse/traverser.h"
#include "occlod/view/view.h"

namespace occlod::hlod {

class ObjectFrame {
 public:
  ObjectFrame(const View& view, const PlacedHlod& placed, const TraverseOptions& options);

  [[nodiscard]] double error_px(const Node& node) const;
  // Refined within as far as possible.
  [[nodiscard]] double least_error_px(const Node& node) const;
  // Object units; of so many pixels.
  [[nodiscard]] double error_limit(const Node& node, double pixels) const;
  // By which nodes are taken in turn: world units from the eye, or from the eye plane where rays are parallel.
  [[nodiscard]] double distance(const Box& box) const;
  // False only when no point of the box is inside the frustum.
  [[nodiscard]] bool may_be_inside(const Box& box) const;
  // Share of the image that a box covers, whether inside it or not: box_coverage().
  [[nodiscard]] double coverage(const Box& box) const;
  // Of the image.
  [[nodiscard]] double pixels() const noexcept { return static_cast<double>(screen_.width) * screen_.height; }
  // Pixels that the node's box covers on an empty screen, as `alpha` counts them. Nothing where devices would not draw
  // it but count all pixels, as around the eye: such nodes are visible.
  [[nodiscard]] std::optional<double> box_pixels(const Node& node) const;

 private:
  [[nodiscard]] std::optional<double> outline_pixels(const Box& box) const;
  [[nodiscard]] double cube_pixels(const Node& node) const;

  ObjectView view_;
  ScreenScale scale_;
  Screen screen_;
  ProxySpace proxy_space_;
  glm::dvec4 depth_;     // dot product with (p, 1): distance from the eye plane, world units
  double volume_scale_;  // cubic world units per cubic object unit
  Metric metric_;
  Alpha alpha_;
};

}  // namespace occlod::hlod
