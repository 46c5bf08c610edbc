#include "hlod/draw/object_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "occlod/traverse/occlusion_probability.h"
#include "hlod/draw/outline_area.h"

namespace occlod::hlod {

ObjectFrame::ObjectFrame(const View& view, const PlacedHlod& placed, const TraverseOptions& options)
    : view_(view, placed.object_to_world),
      scale_(screen_scale(view, view_)),
      screen_(view),
      proxy_space_(proxy_space(screen_, view, view_)),
      volume_scale_(std::abs(glm::determinant(glm::dmat3(placed.object_to_world)))),
      metric_(options.metric),
      alpha_(options.alpha) {
  const glm::dmat4x3& to_eye = view_.object_to_eye();
  const glm::dvec3& ahead = view.direction();
  depth_ = {glm::dot(ahead, to_eye[0]), glm::dot(ahead, to_eye[1]), glm::dot(ahead, to_eye[2]),
            glm::dot(ahead, to_eye[3])};
}

double ObjectFrame::error_px(const Node& node) const {
  if (metric_ == Metric::guaranteed) return guaranteed_error_px(node, scale_);
  return metric_ == Metric::box ? screen_error_px(node, scale_) : sphere_error_px(node, scale_);
}

double ObjectFrame::least_error_px(const Node& node) const {
  if (metric_ == Metric::guaranteed) return guaranteed_error_px(node, scale_);  // how little is left is not known
  return metric_ == Metric::box ? least_screen_error_px(node, scale_) : least_sphere_error_px(node, scale_);
}

double ObjectFrame::error_limit(const Node& node, double pixels) const {
  return metric_ == Metric::box ? screen_error_limit(node, scale_, pixels) : sphere_error_limit(node, scale_, pixels);
}

double ObjectFrame::distance(const Box& box) const {
  if (!scale_.orthographic) return distance_to(box, scale_);
  const glm::dvec3 normal(depth_);
  const glm::dvec3 nearest = glm::min(normal * glm::dvec3(box.min), normal * glm::dvec3(box.max));
  return nearest.x + nearest.y + nearest.z + depth_.w;
}

bool ObjectFrame::may_be_inside(const Box& box) const {
  return std::all_of(view_.planes().begin(), view_.planes().end(), [&](const glm::vec4& plane) {
    const glm::dvec3 normal(plane);
    const glm::dvec3 to_min = normal * glm::dvec3(box.min), to_max = normal * glm::dvec3(box.max);
    const glm::dvec3 innermost = glm::max(to_min, to_max), terms = glm::max(glm::abs(to_min), glm::abs(to_max));
    const double offset = plane.w;
    const double slack = 1e-6 * (terms.x + terms.y + terms.z + std::abs(offset));  // planes are floats
    return !(innermost.x + innermost.y + innermost.z + offset < -slack);
  });
}

double ObjectFrame::coverage(const Box& box) const {
  const glm::dvec3 extent = scale_.axis_stretch * (glm::dvec3(box.max) - glm::dvec3(box.min));
  const double area = 2.0 * (extent.x * extent.y + extent.y * extent.z + extent.z * extent.x);
  return box_coverage(area, distance(box), {scale_.focal_length_px, pixels(), scale_.orthographic});
}

std::optional<double> ObjectFrame::box_pixels(const Node& node) const {
  const std::optional<double> outline = outline_pixels(node.box);
  if (!outline) return std::nullopt;
  return alpha_ == Alpha::exact ? *outline : cube_pixels(node);
}

std::optional<double> ObjectFrame::outline_pixels(const Box& box) const {
  const BoxProxy proxy = project_box(screen_, proxy_space_, box);
  if (proxy.kind == BoxProxy::Kind::uncertain) return std::nullopt;
  if (proxy.kind == BoxProxy::Kind::beside) return 0.0;
  std::array<glm::dvec2, 8> corners;
  std::transform(proxy.image.corners.begin(), proxy.image.corners.end(), corners.begin(),
                 [](const glm::dvec3& corner) { return glm::dvec2(corner); });
  return hull_area_inside(corners, {screen_.width, screen_.height});
}

// C06, sec. 4.3: the face of a cube of the same volume, at the distance of the centre of the bounding sphere; at most
// the image, which the paper does not say.
double ObjectFrame::cube_pixels(const Node& node) const {
  const glm::dvec3 extent = glm::dvec3(node.box.max) - glm::dvec3(node.box.min);
  const double edge = std::cbrt(extent.x * extent.y * extent.z * volume_scale_);
  const glm::dvec3 center = view_.object_to_eye() * glm::dvec4(node.sphere.center, 1.0);
  const double distance = scale_.orthographic ? 1.0 : std::max(glm::length(center), scale_.least_distance);
  const double edge_px = edge * scale_.focal_length_px / distance;
  return std::min(edge_px * edge_px, static_cast<double>(screen_.width) * screen_.height);
}

}  // namespace occlod::hlod
