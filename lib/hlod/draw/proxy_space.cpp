#include "hlod/draw/proxy_space.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>

namespace occlod {
namespace {

// A pixel of the target is touched at most half its diagonal, 0.708 pixels, away from its centre. The rest is for the
// 1/256 pixel of the rasteriser and for rounding.
constexpr double growth_px = 0.75;

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// Square root of the largest absolute row sum of M M^T: at least the largest stretch of M, and equal to it for a
// rotation times a scale.
double largest_stretch(const glm::dmat3& m) {
  const glm::dmat3 square = m * glm::transpose(m);
  double largest = 0.0;
  for (int column = 0; column < 3; ++column) {
    const glm::dvec3 c = glm::abs(square[column]);
    largest = std::max(largest, c.x + c.y + c.z);
  }
  return std::sqrt(largest);
}

}  // namespace

Screen::Screen(const View& view, int target_divisor)
    : width(view.width()),
      height(view.height()),
      divisor(target_divisor),
      focal_length_px(view.focal_length_px()),
      depth_range(view.camera().far - view.camera().near),
      orthographic(view.is_orthographic()) {}

ProxySpace::ProxySpace(const Screen& screen, const glm::dmat4& to_clip, bool is_mirrored)
    : object_to_clip(to_clip), mirrored(is_mirrored) {
  // Rows of clip space scaled to pixels times w: x and y in pixels once divided by w, and the distance from the eye
  // plane, which is w but for orthographic views, scaled like y.
  const glm::dvec3 x = glm::dvec3(glm::row(object_to_clip, 0)) * (screen.width / 2.0);
  const glm::dvec3 y = glm::dvec3(glm::row(object_to_clip, 1)) * (screen.height / 2.0);
  const glm::dvec3 distance = screen.orthographic ? glm::dvec3(glm::row(object_to_clip, 2)) * (screen.depth_range / 2.0)
                                                  : glm::dvec3(glm::row(object_to_clip, 3));
  object_from_pixels = glm::inverse(glm::transpose(glm::dmat3(x, y, screen.focal_length_px * distance)));
  reach = largest_stretch(object_from_pixels);
}

std::optional<Placement> place_box(const Box& box) {
  if (!finite(box.min) || !finite(box.max) || glm::any(glm::lessThan(box.max, box.min))) return std::nullopt;
  const glm::dvec3 min(box.min);
  const glm::dvec3 max(box.max);
  return Placement{ProxyShape::box, (min + max) / 2.0, glm::dmat3(1.0), (max - min) / 2.0};
}

Placement grown(const Placement& placement, const Screen& screen, const ProxySpace& space) {
  const glm::dvec4 w = glm::row(space.object_to_clip, 3);
  double farthest_w = glm::dot(w, glm::dvec4(placement.center, 1.0));
  for (int i = 0; i < 3; ++i)
    farthest_w += std::abs(glm::dot(glm::dvec3(w), placement.directions[i])) * placement.half[i];
  // A point at depth w is half a diagonal of a pixel away from that pixel's centre: growth_px * w in pixels of the
  // target times depth.
  const double growth = growth_px * screen.divisor * std::max(farthest_w, 0.0);
  Placement result = placement;
  for (int i = 0; i < 3; ++i) {
    const bool round = placement.shape == ProxyShape::sphere || (placement.shape == ProxyShape::cylinder && i < 2);
    result.half[i] += growth * (round ? space.reach : glm::length(placement.directions[i] * space.object_from_pixels));
  }
  return result;
}

}  // namespace occlod
