#include "hlod/draw/frame_scene.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "occlod/traverser.h"

namespace occlod::hlod {
namespace {

constexpr std::size_t max_points = 8;

// Holds a convex polygon. Each of the image's four sides cuts off corners and adds at most one.
struct Polygon {
  std::array<glm::dvec2, max_points + 4> corners;
  std::size_t size = 0;

  void add(const glm::dvec2& p) { corners[size++] = p; }
};

double cross(const glm::dvec2& o, const glm::dvec2& a, const glm::dvec2& b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

// Returns the convex hull by Andrew's monotone chain: the lower half from left to right, then the upper half back.
Polygon hull_of(std::span<const glm::dvec2> points) {
  std::array<glm::dvec2, max_points> sorted;
  auto end = sorted.begin();
  for (const glm::dvec2& p : points) {
    const auto place = std::upper_bound(sorted.begin(), end, p, [](const glm::dvec2& a, const glm::dvec2& b) {
      return a.x != b.x ? a.x < b.x : a.y < b.y;
    });
    std::move_backward(place, end, end + 1);
    *place = p;
    ++end;
  }
  Polygon hull;
  std::size_t fixed = 1;  // number of corners that the current half must keep
  const auto extend = [&](const glm::dvec2& p) {
    while (hull.size > fixed && cross(hull.corners[hull.size - 2], hull.corners[hull.size - 1], p) <= 0.0) --hull.size;
    hull.add(p);
  };
  const std::size_t n = points.size();
  hull.add(sorted[0]);
  for (std::size_t i = 1; i < n; ++i) extend(sorted[i]);
  fixed = hull.size;
  for (std::size_t i = n - 1; i-- > 0;) extend(sorted[i]);
  --hull.size;  // it repeats the first corner
  return hull;
}

// Returns the part where p[axis] >= 0 or, for the opposite side, p[axis] <= end (Sutherland & Hodgman).
Polygon clipped(const Polygon& polygon, int axis, double sign, double end) {
  Polygon result;
  const auto inside = [&](const glm::dvec2& p) { return sign * p[axis] <= end; };
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const glm::dvec2& a = polygon.corners[i];
    const glm::dvec2& b = polygon.corners[(i + 1) % polygon.size];
    if (inside(a)) result.add(a);
    if (inside(a) == inside(b)) continue;
    glm::dvec2 cut = a + (b - a) * ((sign * end - a[axis]) / (b[axis] - a[axis]));
    cut[axis] = sign * end;
    result.add(cut);
  }
  return result;
}

}  // namespace

double hull_area_inside(std::span<const glm::dvec2> points, const glm::dvec2& size) {
  assert(!points.empty() && points.size() <= max_points);
  Polygon polygon = hull_of(points);
  for (int axis = 0; axis < 2; ++axis) {
    polygon = clipped(polygon, axis, -1.0, 0.0);
    polygon = clipped(polygon, axis, 1.0, size[axis]);
  }
  double twice = 0.0;
  for (std::size_t i = 2; i < polygon.size; ++i)
    twice += cross(polygon.corners[0], polygon.corners[i - 1], polygon.corners[i]);
  return std::max(twice / 2.0, 0.0);
}

ObjectFrame::ObjectFrame(const View& view, const PlacedHlod& placed, const Trial& trial)
    : view_(view, placed.object_to_world),
      scale_(screen_scale(view, view_)),
      screen_(view),
      proxy_space_(proxy_space(screen_, view, view_)),
      volume_scale_(std::abs(glm::determinant(glm::dmat3(placed.object_to_world)))),
      metric_(trial.metric),
      alpha_(trial.alpha) {
  const glm::dmat4x3& to_eye = view_.object_to_eye();
  const glm::dvec3& ahead = view.direction();
  depth_ = {glm::dot(ahead, to_eye[0]), glm::dot(ahead, to_eye[1]), glm::dot(ahead, to_eye[2]),
            glm::dot(ahead, to_eye[3])};
}

double ObjectFrame::error_px(const Node& node) const {
  if (metric_ == Metric::guaranteed) return guaranteed_error_px(node, scale_);
  return metric_ == Metric::box ? screen_error_px(node, scale_) : sphere_error_px(node, scale_);
}

double ObjectFrame::min_error_px(const Node& node) const {
  if (metric_ == Metric::guaranteed) return guaranteed_error_px(node, scale_);  // its minimum is unknown
  return metric_ == Metric::box ? min_screen_error_px(node, scale_) : min_sphere_error_px(node, scale_);
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
    const double slack = 1e-6 * (terms.x + terms.y + terms.z + std::abs(offset));  // because planes are floats
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

// Charalambos 2006, sec. 4.3, takes the face of a cube of the same volume at the distance of the centre of the bounding
// sphere. We limit it to the image, which the paper does not mention.
double ObjectFrame::cube_pixels(const Node& node) const {
  const glm::dvec3 extent = glm::dvec3(node.box.max) - glm::dvec3(node.box.min);
  const double edge = std::cbrt(extent.x * extent.y * extent.z * volume_scale_);
  const glm::dvec3 center = view_.object_to_eye() * glm::dvec4(node.sphere.center, 1.0);
  const double distance = scale_.orthographic ? 1.0 : std::max(glm::length(center), scale_.min_distance);
  const double edge_px = edge * scale_.focal_length_px / distance;
  return std::min(edge_px * edge_px, static_cast<double>(screen_.width) * screen_.height);
}

FrameScene::FrameScene(std::span<const PlacedHlod> objects) {
  for (const PlacedHlod& object : objects) {
    hlods_.push_back(object.hlod);
    stores_.push_back(object.hlod->store());
    states_.emplace_back(object.hlod->node_count());
  }
}

void FrameScene::forget() {
  for (std::vector<NodeState>& states : states_) std::fill(states.begin(), states.end(), NodeState());
  frame_ = 0;
  reached_last_ = 0;
}

void FrameScene::begin_frame(const View& view, std::span<const PlacedHlod> objects, const TraverseOptions& options,
                             const Trial& trial, bool biased) {
  if (frame_ == std::numeric_limits<std::uint32_t>::max() - 1) forget();
  ++frame_;
  options_ = options;
  trial_ = trial;
  biased_ = biased && trial.biased;
  frames_.clear();
  for (const PlacedHlod& object : objects) frames_.emplace_back(view, object, trial);
}

bool FrameScene::is_within_tolerance(NodeRef n, double bias) const {
  return node(n).level == 0 || (options_.tolerance_px > 0.0 && bias * min_error_px(n) <= options_.tolerance_px);
}

bool FrameScene::lacks_children(NodeRef n) const {
  const NodeStore* const store = stores_[n.object];
  return store != nullptr && std::ranges::any_of(hlod(n).children(n.node), [&](NodeId child) {
           return !store->may_have(child) && view_of(n).may_be_inside(hlod(n).node(child).box);
         });
}

void FrameScene::need(NodeRef n) const {
  if (stores_[n.object] != nullptr && hlod(n).is_resident(n.node)) stores_[n.object]->need(n.node);
}

void FrameScene::find_children_inside(NodeRef n) {
  children_inside_.clear();
  for (const NodeId child : hlod(n).children(n.node))
    if (view_of(n).may_be_inside(hlod(n).node(child).box)) children_inside_.push_back(child);
}

bool FrameScene::fetch_children(NodeRef n) {
  if (stores_[n.object] == nullptr) return true;
  find_children_inside(n);
  return stores_[n.object]->fetch(children_inside_);
}

void FrameScene::want_children(NodeRef n, double bias) {
  find_children_inside(n);
  stores_[n.object]->want(children_inside_, bias * error_px(n));
}

bool FrameScene::stops(NodeRef n, double bias) {
  if (!is_fine(n, bias)) return false;
  NodeState& s = state(n);
  const bool has_floor = s.floor_frame != 0 && s.floor_frame + 1 == frame_;
  if (!has_floor || static_cast<double>(s.bias_floor) <= bias || is_fine(n, static_cast<double>(s.bias_floor)))
    return true;
  s.floored = true;
  return false;
}

void FrameScene::raise_floor(NodeRef n) {
  constexpr double beyond = 1.01;  // relative to the tolerance
  NodeState& s = state(n);
  s.bias_floor = static_cast<float>(std::min(1.0, beyond * options_.tolerance_px / min_error_px(n)));
  s.floor_frame = frame_;
}

double box_coverage(double box_area, double distance, const ImageScale& image) noexcept {
  if (!image.orthographic && !(distance > 0.0)) return 1.0;
  const double scale = image.focal_length_px / (image.orthographic ? 1.0 : distance);
  return std::min(1.0, scale * scale * box_area / (6.0 * image.pixels));
}

double coverage_ratio(double mesh_area, double box_area) noexcept {
  return box_area > 0.0 ? 1.5 * mesh_area / box_area : 1.0;
}

double mesh_coverage(double box_share, double ratio) noexcept { return box_share * std::min(ratio, 1.0); }

double covered_with(double covered, double share) noexcept { return covered + (1.0 - covered) * share; }

double cover_probability(double covered, double box_share) noexcept {
  if (!(box_share < covered)) return 0.0;
  const double room = std::sqrt(covered) - std::sqrt(box_share);
  return room * room;
}

double occlusion_probability(double cover_probability, LastSight last) noexcept {
  switch (last) {
    case LastSight::visible:
      return 0.5 * cover_probability * cover_probability;
    case LastSight::outside:
      return cover_probability;
    case LastSight::hidden:
      break;
  }
  return 1.0;
}

namespace {

// Joins two parabolas at t, with slope 2 there.
double sigmoid(double mu, double t) {
  return mu <= t && t > 0.0 ? mu * mu / t : 1.0 - (1.0 - mu) * (1.0 - mu) / (1.0 - t);
}

}  // namespace

double Bias::operator()(double mu) const noexcept {
  if (!(mu > 0.0)) return 0.0;
  if (mu >= 1.0) return 1.0;
  return (1.0 - s) * mu + s * sigmoid(mu, t);
}

}  // namespace occlod::hlod
