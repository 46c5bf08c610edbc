#include "occlod/hlod/metric.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace occlod::hlod {
namespace {

double distance_to(const Box& box, const glm::dvec3& p) {
  const glm::dvec3 below = glm::dvec3(box.min) - p, above = p - glm::dvec3(box.max);
  return glm::length(glm::max(glm::max(below, above), glm::dvec3(0.0)));
}

}  // namespace

double screen_error_px(const Node& node, const ScreenScale& scale) {
  const auto error_at = [&](double error, const Box& box) {
    return error / std::max(distance_to(box, scale.eye), scale.least_distance);
  };
  return scale.focal_length_px * std::max(error_at(static_cast<double>(node.error), node.box),
                                          error_at(static_cast<double>(node.child_error), node.lod_box));
}

double sphere_error_px(const Node& node, const ScreenScale& scale) {
  const double distance =
      glm::distance(glm::dvec3(node.sphere.center), scale.eye) - static_cast<double>(node.sphere.radius);
  return scale.focal_length_px * static_cast<double>(node.error) / std::max(distance, scale.least_distance);
}

}  // namespace occlod::hlod
