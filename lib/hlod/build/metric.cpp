#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "occlod/hlod.h"

namespace occlod::hlod {
namespace {

// Returns the pixels that an error of `error` object units covers at most at this distance.
double error_px(float error, double distance, const ScreenScale& scale) {
  const double covered_at_1 = scale.focal_length_px * scale.largest_stretch * static_cast<double>(error);
  return scale.orthographic ? covered_at_1 : covered_at_1 / std::max(distance, scale.min_distance);
}

// Returns the inverse: the object units that cover this many pixels.
double error_limit(double pixels, double distance, const ScreenScale& scale) {
  const double covers_1 = 1.0 / (scale.focal_length_px * scale.largest_stretch);
  return pixels * covers_1 * (scale.orthographic ? 1.0 : std::max(distance, scale.min_distance));
}

// Returns a distance that is at most that to the nearest point of the sphere; negative inside.
double distance_to(const Sphere& sphere, const ScreenScale& scale) {
  const double to_center = glm::length(scale.axis_stretch * (glm::dvec3(sphere.center) - scale.eye));
  return to_center - static_cast<double>(sphere.radius) * scale.largest_stretch;
}

// Returns the world units per object unit along each axis, if the axes stay at right angles; otherwise the least
// stretch in any direction, which is 1 over the largest stretch of the inverse.
glm::dvec3 axis_stretch(const glm::dmat3& linear) {
  const glm::dvec3 lengths(glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2]));
  const auto cosine = [&](int a, int b) { return std::abs(glm::dot(linear[a] / lengths[a], linear[b] / lengths[b])); };
  constexpr double rounding = 1e-12;
  if (std::max({cosine(0, 1), cosine(1, 2), cosine(2, 0)}) <= rounding) return lengths;
  const glm::dmat3 inverse = glm::inverse(linear);
  const glm::dmat3 square = glm::transpose(inverse) * inverse;
  double largest = 0.0;  // at least the largest eigenvalue
  for (int column = 0; column < 3; ++column) {
    const glm::dvec3 c = glm::abs(square[column]);
    largest = std::max(largest, c.x + c.y + c.z);
  }
  return glm::dvec3(1.0 / std::sqrt(largest));
}

}  // namespace

ScreenScale screen_scale(const View& view, const ObjectView& object) {
  const glm::dmat3 linear(object.object_to_eye());
  ScreenScale scale;
  scale.eye = glm::inverse(linear) * -object.object_to_eye()[3];
  scale.focal_length_px = view.focal_length_px();
  scale.min_distance = view.camera().near;
  scale.axis_stretch = axis_stretch(linear);
  scale.largest_stretch = object.largest_stretch();
  scale.orthographic = view.is_orthographic();
  return scale;
}

double distance_to(const Box& box, const ScreenScale& scale) {
  const glm::dvec3 below = glm::dvec3(box.min) - scale.eye, above = scale.eye - glm::dvec3(box.max);
  return glm::length(scale.axis_stretch * glm::max(glm::max(below, above), glm::dvec3(0.0)));
}

double screen_error_px(const Node& node, const ScreenScale& scale) {
  return std::max(error_px(node.error, distance_to(node.box, scale), scale), min_screen_error_px(node, scale));
}

double sphere_error_px(const Node& node, const ScreenScale& scale) {
  return error_px(node.error, distance_to(node.sphere, scale), scale);
}

double guaranteed_error_px(const Node& node, const ScreenScale& scale) {
  return error_px(node.guaranteed_error, distance_to(node.lod_box, scale), scale);
}

double min_screen_error_px(const Node& node, const ScreenScale& scale) {
  return error_px(node.child_error, distance_to(node.lod_box, scale), scale);
}

double min_sphere_error_px(const Node& node, const ScreenScale& scale) {
  return error_px(node.child_error, distance_to(node.sphere, scale), scale);
}

double screen_error_limit(const Node& node, const ScreenScale& scale, double pixels) {
  return error_limit(pixels, distance_to(node.box, scale), scale);
}

double sphere_error_limit(const Node& node, const ScreenScale& scale, double pixels) {
  return error_limit(pixels, distance_to(node.sphere, scale), scale);
}

}  // namespace occlod::hlod
