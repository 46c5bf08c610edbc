#include "hlod/draw/box_proxy.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <optional>

namespace occlod {
namespace {

// A box touches a pixel of the target at most half the pixel's diagonal, 0.708 pixels, away from its centre. The rest
// covers the rasteriser's 1/256 pixel and rounding.
constexpr double growth_px = 0.75;

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// Returns the square root of the largest absolute row sum of M M^T: at least the largest stretch of M, and equal to it
// for a rotation times a scale.
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
  // These are rows of clip space scaled to pixels times w: x and y are in pixels once divided by w. The distance from
  // the eye plane, which is w except in orthographic views, is scaled like y.
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
  // At depth w, half a diagonal of a pixel measures growth_px * w in pixels of the target times depth.
  const double growth = (growth_px * screen.divisor + screen.slack_px) * std::max(farthest_w, 0.0);
  Placement result = placement;
  for (int i = 0; i < 3; ++i) {
    const bool round = placement.shape == ProxyShape::sphere || (placement.shape == ProxyShape::cylinder && i < 2);
    result.half[i] += growth * (round ? space.reach : glm::length(placement.directions[i] * space.object_from_pixels));
  }
  return result;
}

namespace {

// Proxies that reach farther than this from the middle of the image, in pixels, are not drawn, because there single
// precision is coarser than 1/256 pixel.
constexpr double farthest_px = 65536.0;

// Bounds the error of a single-precision depth buffer relative to its largest value, with room to spare. Growing by a
// part of a pixel moves boxes by more, except for telescopes and for orthographic views of long range.
constexpr double depth_slack = 8.0 * std::numeric_limits<float>::epsilon();

glm::dmat4 unit_to_object(const Placement& placement) {
  glm::dmat4 matrix(1.0);
  for (int i = 0; i < 3; ++i) matrix[i] = glm::dvec4(placement.half[i] * placement.directions[i], 0.0);
  matrix[3] = glm::dvec4(placement.center, 1.0);
  return matrix;
}

glm::dvec3 to_image(const glm::dvec4& clip, const Screen& screen) {
  const double inverse_w = 1.0 / clip.w;
  const double nearness = screen.orthographic ? (clip.w - clip.z) * 0.5 + depth_slack : inverse_w * (1.0 + depth_slack);
  return {(0.5 + 0.5 * clip.x * inverse_w) * screen.width, (0.5 - 0.5 * clip.y * inverse_w) * screen.height, nearness};
}

}  // namespace

ProxySpace proxy_space(const Screen& screen, const View& view, const ObjectView& object) {
  return {screen, clip_matrix(view.camera(), object), object.mirrored()};
}

BoxProxy project_box(const Screen& screen, const ProxySpace& space, const Box& box) {
  BoxProxy proxy;
  const std::optional<Placement> placement = place_box(box);
  if (!placement) return proxy;
  proxy.unit_to_clip = space.object_to_clip * unit_to_object(grown(*placement, screen, space));
  proxy.image.mirrored = space.mirrored;
  const double infinity = std::numeric_limits<double>::infinity();
  proxy.min = glm::dvec2(infinity);
  proxy.max = glm::dvec2(-infinity);
  double nearest = infinity, farthest = -infinity;  // distances to the near plane, positive in front of it
  bool finite = true;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec4 clip = proxy.unit_to_clip * glm::dvec4((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0,
                                                            (i & 4) != 0 ? 1.0 : -1.0, 1.0);
    nearest = std::min(nearest, clip.z + clip.w);
    farthest = std::max(farthest, clip.z + clip.w);
    const glm::dvec3 corner = to_image(clip, screen);
    finite = finite && std::isfinite(clip.z + clip.w) && std::isfinite(corner.x + corner.y + corner.z);
    proxy.image.corners[static_cast<std::size_t>(i)] = corner;
    proxy.min = glm::min(proxy.min, glm::dvec2(corner));
    proxy.max = glm::max(proxy.max, glm::dvec2(corner));
  }
  if (finite && farthest < 0.0) {
    proxy.kind = BoxProxy::Kind::beside;
    return proxy;
  }
  // The near plane lies in front of the eye, so this also rejects boxes around the eye.
  if (!finite || !(nearest > 0.0)) return proxy;
  const glm::dvec2 size(screen.width, screen.height);
  if (glm::any(glm::lessThan(proxy.max, glm::dvec2(0.0))) || glm::any(glm::greaterThan(proxy.min, size)))
    proxy.kind = BoxProxy::Kind::beside;
  else if (glm::all(glm::greaterThan(proxy.min, size / 2.0 - farthest_px)) &&
           glm::all(glm::lessThan(proxy.max, size / 2.0 + farthest_px)))
    proxy.kind = BoxProxy::Kind::drawn;
  return proxy;
}

std::uint32_t covered_pixels(const Screen& screen, const BoxProxy& proxy, raster::BoxOutline& outline) {
  if (proxy.kind == BoxProxy::Kind::beside) return 0;
  if (proxy.kind == BoxProxy::Kind::uncertain)
    return static_cast<std::uint32_t>(screen.width) * static_cast<std::uint32_t>(screen.height);
  outline.assign(proxy.image, screen.width, screen.height);
  return outline.pixels();
}

}  // namespace occlod
