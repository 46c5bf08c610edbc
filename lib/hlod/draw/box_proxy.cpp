#include "hlod/draw/box_proxy.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <optional>

#include "hlod/draw/clip_matrix.h"

namespace occlod {
namespace {

// Proxies that reach farther from the middle of the image, in pixels, are not drawn: there single precision is coarser
// than 1/256 pixel.
constexpr double farthest_px = 65536.0;

// What a depth buffer of single precision may be off by, of its largest value, with room to spare. Growing by a part of
// a pixel is more, but for telescopes and for parallel rays over long ranges.
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
  double nearest = infinity, farthest = -infinity;  // distances to the near plane, positive before the eye
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
  // The near plane lies in front of the eye, so this holds back boxes around the eye too.
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
