#include "overlays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "palette.h"
#include "refine/tuning.h"
#include "scene/frustum_edges.h"

namespace occlod::viewer {
namespace {

constexpr Pen frustum_pen{{0.98F, 0.80F, 0.20F, 1.0F}, 2.0, 0.35};
constexpr Pen bounds_pen{{0.16F, 0.55F, 0.83F, 1.0F}, 1.5, 0.3};
constexpr Pen star_pen{{0.10F, 0.10F, 0.12F, 1.0F}, 1.5, 0.1};
constexpr Pen triangle_pen{{0.86F, 0.20F, 0.27F, 1.0F}, 3.0, 0.3};
constexpr Pen cone_pen{{0.30F, 0.65F, 0.25F, 1.0F}, 1.5, 0.3};
constexpr Pen measure_pen{{0.95F, 0.30F, 0.10F, 1.0F}, 2.5, 0.7};
constexpr Pen path_pen{{0.86F, 0.36F, 0.20F, 1.0F}, 1.5, 0.6};

// Adds lines of one object, given in its own space.
class ObjectLines {
 public:
  ObjectLines(std::vector<Line>& lines, const glm::dmat4& object_to_world) : lines_(lines), matrix_(object_to_world) {}

  void line(const glm::dvec3& a, const glm::dvec3& b, const Pen& pen) {
    lines_.push_back({glm::dvec3(matrix_ * glm::dvec4(a, 1.0)), glm::dvec3(matrix_ * glm::dvec4(b, 1.0)), pen});
  }
  void triangle(const std::array<glm::dvec3, 3>& corners, const Pen& pen) {
    for (std::size_t i = 0; i < 3; ++i) line(corners[i], corners[(i + 1) % 3], pen);
  }
  void circle(const glm::dvec3& center, const glm::dvec3& x, const glm::dvec3& y, const Pen& pen) {
    constexpr int pieces = 64;
    glm::dvec3 last = center + x;
    for (int i = 1; i <= pieces; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / pieces;
      const glm::dvec3 next = center + std::cos(angle) * x + std::sin(angle) * y;
      line(last, next, pen);
      last = next;
    }
  }

 private:
  std::vector<Line>& lines_;
  glm::dmat4 matrix_;
};

struct Frame {
  glm::dvec3 x, y, z;
};

Frame around(const glm::dvec3& axis) {
  const glm::dvec3 other = std::abs(axis.x) < 0.5 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
  const glm::dvec3 x = glm::normalize(glm::cross(axis, other));
  return {x, glm::cross(axis, x), axis};
}

void add_sphere(ObjectLines& lines, const Sphere& sphere) {
  const glm::dvec3 center(sphere.center);
  const auto r = static_cast<double>(sphere.radius);
  const std::array<glm::dvec3, 3> axes = {{{r, 0.0, 0.0}, {0.0, r, 0.0}, {0.0, 0.0, r}}};
  for (std::size_t i = 0; i < 3; ++i) lines.circle(center, axes[i], axes[(i + 1) % 3], bounds_pen);
}

void add_box(ObjectLines& lines, const Box& box, const Pen& pen) {
  for (int i = 0; i < 8; ++i)
    for (const int bit : {1, 2, 4})
      if ((i & bit) == 0) lines.line(glm::dvec3(corner(box, i)), glm::dvec3(corner(box, i | bit)), pen);
}

void add_cylinder(ObjectLines& lines, const Cylinder& cylinder) {
  const Frame frame = around(glm::dvec3(cylinder.axis));
  const auto r = static_cast<double>(cylinder.radius);
  const glm::dvec3 low = glm::dvec3(cylinder.center) + static_cast<double>(cylinder.t_min) * frame.z;
  const glm::dvec3 high = glm::dvec3(cylinder.center) + static_cast<double>(cylinder.t_max) * frame.z;
  lines.circle(low, r * frame.x, r * frame.y, bounds_pen);
  lines.circle(high, r * frame.x, r * frame.y, bounds_pen);
  for (const glm::dvec3& side : {frame.x, frame.y, -frame.x, -frame.y})
    lines.line(low + r * side, high + r * side, bounds_pen);
}

void add_cone(ObjectLines& lines, const SplitNode& node) {
  const NormalCone cone = node.cone();
  if (!cone.culls()) return;
  const Frame frame = around(glm::dvec3(cone.axis));
  const glm::dvec3 apex(node.sphere.center);
  const double length = static_cast<double>(node.sphere.radius);
  const auto cosine = static_cast<double>(cone.cos_angle);
  const double sine = std::sqrt(std::max(1.0 - cosine * cosine, 0.0));
  const glm::dvec3 rim = apex + length * cosine * frame.z;
  lines.circle(rim, length * sine * frame.x, length * sine * frame.y, cone_pen);
  for (const glm::dvec3& side : {frame.x, frame.y, -frame.x, -frame.y})
    lines.line(apex, rim + length * sine * side, cone_pen);
  lines.line(apex, apex + length * frame.z, cone_pen);
}

void add_split(ObjectLines& lines, const Settings& settings, const Hierarchy& hierarchy, SplitId split) {
  const auto corners = [&](const Triangle& t) {
    return std::array<glm::dvec3, 3>{hierarchy.positions()[t.x], hierarchy.positions()[t.y],
                                     hierarchy.positions()[t.z]};
  };
  const SplitNode& node = hierarchy.node(split);
  for (const Triangle& t : hierarchy.faces_of(split).inserted) lines.triangle(corners(t), star_pen);
  if (settings.look.bounds && tuning_of(settings.refine).proxy == Proxy::sphere) add_sphere(lines, node.sphere);
  if (settings.look.bounds && tuning_of(settings.refine).proxy == Proxy::box) add_box(lines, node.box(), bounds_pen);
  if (settings.look.bounds && tuning_of(settings.refine).proxy == Proxy::cylinder) add_cylinder(lines, node.cylinder());
  if (settings.look.cone) add_cone(lines, node);
}

void add_pick(std::vector<Line>& all, const Session& session, const PlacedObject& object) {
  const Pick& pick = *session.state().pick;
  const Settings& settings = session.state().settings;
  ObjectLines lines(all, object.object_to_world);
  if (pick.split != no_id) add_split(lines, settings, *object.mesh->hierarchy, pick.split);
  if (pick.node != no_id && settings.look.bounds) add_box(lines, object.hlod->hlod->node(pick.node).box, bounds_pen);
  lines.triangle(pick.corners, triangle_pen);
}

Pen box_pen(const glm::u8vec4& color) { return {glm::vec4(color) / 255.0F, 1.5, 0.5}; }

// Adds boxes of the nodes of one side, over each other where they share edges: first drawn ones, then hidden nodes, and
// wasted queries last.
void add_asked_boxes(std::vector<Line>& all, const Objects& objects, const hlod::Frame& frame) {
  const auto add = [&](std::uint32_t object, hlod::NodeId node, const glm::u8vec4& color) {
    ObjectLines lines(all, objects[object].object_to_world);
    add_box(lines, objects[object].hlod->hlod->node(node).box, box_pen(color));
  };
  for (const hlod::DrawnNode& draw : frame.draws)
    if (!draw.asked) add(draw.object, draw.node, unasked_box_color);
  for (const hlod::Answer answer :
       {hlod::Answer::unread, hlod::Answer::visible, hlod::Answer::hidden, hlod::Answer::wasted})
    for (const hlod::NodeAnswer& asked : frame.asked)
      if (asked.answer == answer) add(asked.object, asked.node, color_of(answer));
}

// Adds boxes in the colours of their triangles, or in black where these have none of their own.
void add_drawn_boxes(std::vector<Line>& all, const Objects& objects, const HlodSide& side) {
  const hlod::Frame& frame = side.front->frame;
  for (std::size_t i = 0; i < frame.draws.size(); ++i) {
    const hlod::DrawnNode& draw = frame.draws[i];
    const auto& colors = side.colors[draw.object];
    ObjectLines lines(all, objects[draw.object].object_to_world);
    add_box(lines, objects[draw.object].hlod->hlod->node(draw.node).box,
            colors.empty() ? star_pen : box_pen(colors[side.front->first_triangle[i]]));
  }
}

void add_node_boxes(std::vector<Line>& lines, const RefinedFrame& frame, std::size_t side, NodeBoxes boxes) {
  if (frame.hlod_sides.empty()) return;
  const HlodSide& shown = frame.hlod_sides[std::min(side, frame.hlod_sides.size() - 1)];
  if (boxes == NodeBoxes::drawn) add_drawn_boxes(lines, *frame.job.objects, shown);
  if (boxes == NodeBoxes::asked) add_asked_boxes(lines, *frame.job.objects, shown.front->frame);
}

constexpr Pen cell_pen{{0.98F, 0.55F, 0.10F, 1.0F}, 2.5, 0.5};
constexpr std::size_t max_cell_boxes = 2000;  // those nearest to the eye

void add_cell_box(std::vector<Line>& lines, const CellBox& box, const Pen& pen) {
  const auto corner_of = [&](int i) {
    return glm::dvec3((i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                      (i & 4) != 0 ? box.max.z : box.min.z);
  };
  for (int i = 0; i < 8; ++i)
    for (const int bit : {1, 2, 4})
      if ((i & bit) == 0) lines.push_back({corner_of(i), corner_of(i | bit), pen});
}

// Adds the cell of the eye last, over the others; if it is late, also the node that is drawn instead.
void add_cell_boxes(std::vector<Line>& lines, const CellsFrame& frame, const glm::dvec3& eye, CellBoxes boxes) {
  if (boxes == CellBoxes::none) return;
  const CellTree& tree = frame.cells->file->tree();
  if (boxes != CellBoxes::cell) {
    const CellScale scale = scale_of(*frame.cells, boxes);
    for (const CellId leaf : nearest_leaves(*frame.cells, eye, max_cell_boxes))
      add_cell_box(lines, tree.node(leaf).box, box_pen(box_color(frame, leaf, boxes, scale)));
  }
  if (frame.walked.shown != frame.walked.cell)
    add_cell_box(lines, tree.node(frame.walked.shown).box, box_pen(color_of(CellArrival::late)));
  add_cell_box(lines, tree.node(frame.walked.cell).box, cell_pen);
}

// Returns edges that end behind the scene.
std::vector<std::array<glm::dvec3, 2>> refined_frustum(const Session& session) {
  const View view(session.refine_camera());
  const SceneBounds bounds = bounds_of(*session.state().objects);
  const double reach = glm::dot(bounds.center - view.camera().eye, view.direction()) + bounds.radius;
  const double length = reach > 0.0 ? std::min(reach, view.camera().far) : view.camera().far;
  return picture::frustum_edges(view, length);
}

void add_frustum(std::vector<Line>& lines, const Session& session) {
  for (const auto& [from, to] : refined_frustum(session)) lines.push_back({from, to, frustum_pen});
}

// Adds the distance that is measured, and a cross at each of its ends, as large from everywhere.
void add_measured(std::vector<Line>& lines, const State& state) {
  constexpr double arm_px = 6.0;
  const View view(state.camera);
  for (const glm::dvec3& end : state.measured) {
    const double distance = view.is_orthographic() ? 1.0 : glm::dot(end - state.camera.eye, view.direction());
    const double radius = arm_px * std::max(distance, 0.0) / view.focal_length_px();
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 arm(0.0);
      arm[axis] = radius;
      lines.push_back({end - arm, end + arm, measure_pen});
    }
  }
  if (state.measured.size() == 2) lines.push_back({state.measured[0], state.measured[1], measure_pen});
}

// Returns an orthographic camera from above, which shows an orthographic frustum without distortion, and all of it.
Camera plan_of_box(const Camera& birdseye, const Session& session) {
  Camera camera = orthographic(birdseye);
  const glm::dvec3 right = glm::normalize(glm::cross(camera.target - camera.eye, camera.up));
  constexpr double room = 1.05;
  double half_height = *camera.orthographic_height / 2.0;
  for (const auto& [from, to] : refined_frustum(session)) {
    const glm::dvec3 d = room * (from - camera.target);
    half_height = std::max(
        {half_height, std::abs(glm::dot(d, camera.up)), std::abs(glm::dot(d, right)) * camera.height / camera.width});
  }
  camera.orthographic_height = 2.0 * half_height;
  return camera;
}

}  // namespace

std::vector<Line> main_overlay(const Session& session, std::size_t side) {
  std::vector<Line> lines;
  const State& state = session.state();
  if (session.frame()) add_node_boxes(lines, *session.frame(), side, state.settings.hlod.boxes);
  if (session.frame() && session.frame()->cells && side == 0)
    add_cell_boxes(lines, *session.frame()->cells, session.refine_camera().eye, state.settings.cells.boxes);
  if (state.settings.freeze) add_frustum(lines, session);
  add_measured(lines, state);
  if (state.pick)
    for (const PlacedObject& object : *state.objects)
      if (object.id == state.pick->object && object.shown) add_pick(lines, session, object);
  return lines;
}

std::vector<Line> birdseye_overlay(const Session& session) {
  std::vector<Line> lines;
  add_frustum(lines, session);
  for (Line& line : lines) line.pen.hidden_alpha = 1.0;
  for (const auto& [name, path] : session.state().paths)
    for (std::size_t i = 1; i < path.keys.size(); ++i)
      lines.push_back({path.keys[i - 1].eye, path.keys[i].eye, path_pen});
  return lines;
}

Camera birdseye_camera(const Session& session, int width, int height) {
  const SceneBounds bounds = bounds_of(*session.state().objects);
  const Camera& refined = session.refine_camera();
  const glm::dvec3 up = glm::normalize(refined.up);
  const glm::dvec3 direction = glm::normalize(refined.target - refined.eye);
  const glm::dvec3 ahead = glm::normalize(direction - glm::dot(direction, up) * up);
  // A circle around the scene and the eye, seen from above, must be visible.
  const glm::dvec3 to_eye = refined.eye - bounds.center;
  const glm::dvec3 aside = to_eye - glm::dot(to_eye, up) * up;
  const double distance = glm::length(aside);
  const double radius = std::max((distance + bounds.radius) / 2.0, bounds.radius);
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fov_y_deg = 30.0;
  camera.target = bounds.center;
  if (distance > 0.0) camera.target += aside * ((radius - bounds.radius) / distance);
  const double half = glm::radians(camera.fov_y_deg) / 2.0;
  const double above = std::max(glm::dot(to_eye, up), bounds.radius);
  const double smaller = std::min(1.0, static_cast<double>(width) / height);
  camera.eye = camera.target + (radius / std::tan(half) / smaller + above) * up;
  camera.up = ahead;
  const double depth = glm::length(camera.eye - camera.target);
  camera.far = depth + 2.0 * radius;
  camera.near = camera.far * 1e-3;
  // From above a building shows its roof, so what is higher than an eye inside it is cut off.
  if (any_box_holds(*session.state().objects, refined.eye))
    camera.near = std::max(camera.near, glm::dot(camera.eye - refined.eye, up));
  return refined.orthographic_height ? plan_of_box(camera, session) : camera;
}

}  // namespace occlod::viewer
