// Implements the commands of the camera and its bookmarks.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "arguments.h"
#include "command.h"
#include "navigation.h"
#include "pick.h"
#include "session.h"

namespace occlod::viewer {
namespace {

void fit(Session& session) { hold(session.state().camera, bounds_of(*session.state().objects)); }

// Sets every given field. Planes that are not given fit the scene.
void camera(Session& session, const JsonPlace& action) {
  State& state = session.state();
  Camera camera = state.camera;
  if (action.has("eye")) camera.eye = vector_at(action, "eye");
  if (action.has("target")) camera.target = vector_at(action, "target");
  if (action.has("up")) camera.up = vector_at(action, "up");
  if (action.has("fov_y_deg") && action.has("orthographic_height"))
    action.fail("gives both fov_y_deg and orthographic_height", "give one: a camera is in perspective or orthographic");
  if (action.has("fov_y_deg")) {
    camera.fov_y_deg = action.at("fov_y_deg").number();
    camera.orthographic_height.reset();
  }
  if (action.has("orthographic_height")) camera.orthographic_height = action.at("orthographic_height").number();
  if (!action.has("near") || !action.has("far")) fit_range(camera, bounds_of(*state.objects));
  camera.near = number_or(action, "near", camera.near);
  camera.far = number_or(action, "far", camera.far);
  state.camera = camera;
}

// Switches the projection, to the other one if the action does not say which.
void switch_orthographic(Session& session, const JsonPlace& action) {
  Camera& camera = session.state().camera;
  const auto on = action.find("on");
  set_orthographic(camera, on ? on->boolean() : !camera.orthographic_height, bounds_of(*session.state().objects));
}

void picture_size(Session& session, const JsonPlace& action) {
  State& state = session.state();
  if (action.has("width") != action.has("height"))
    action.fail("has only one of width and height", "give both or neither");
  state.is_sized_for_cells = false;
  if (!action.has("width")) {
    state.fixed_size.reset();
    return;
  }
  constexpr int most = 8192;
  const ImageSize size{action.at("width").integer(1), action.at("height").integer(1)};
  if (size.width > most || size.height > most) action.fail("is larger than 8192 pixels");
  state.fixed_size = size;
  state.camera.width = size.width;
  state.camera.height = size.height;
}

void frame_all(Session& session, const JsonPlace&) {
  frame(session.state().camera, bounds_of(*session.state().objects));
  fit(session);
}

void frame_selected(Session& session, const JsonPlace& action) {
  State& state = session.state();
  for (const PlacedObject& object : *state.objects) {
    if (object.id != state.selected) continue;
    frame(state.camera, bounds_of(object));
    fit(session);
    return;
  }
  action.fail("no object is selected", "click one first");
}

void look_along(Session& session, const JsonPlace& action) {
  if (!view_from(session.state().camera, action.at("side").string(), bounds_of(*session.state().objects)))
    action.at("side").fail(action.at("side").text() + " is no side",
                           "use one of: front, back, left, right, top, bottom");
  fit(session);
}

void orbit_camera(Session& session, const JsonPlace& action) {
  orbit(session.state().camera, action.at("right").number(), action.at("up").number());
  fit(session);
}

void look(Session& session, const JsonPlace& action) {
  look_around(session.state().camera, action.at("right").number(), action.at("up").number());
  fit(session);
}

void pan_camera(Session& session, const JsonPlace& action) {
  pan(session.state().camera, action.at("right").number(), action.at("up").number());
  fit(session);
}

void zoom_camera(Session& session, const JsonPlace& action) {
  const double factor = action.at("factor").number();
  if (!(factor > 0.0 && factor < 1e6)) action.at("factor").fail("is not between 0 and 1,000,000");
  zoom(session.state().camera, factor, place_of(action));
  fit(session);
}

// Keeps the eye's height above the ground: above what is straight below it in the scene.
void stay_on_ground(Session& session) {
  State& state = session.state();
  if (!session.frame()) return;
  const glm::dvec3 up = glm::normalize(state.camera.up);
  const auto below = cast_ray(*session.frame(), {state.camera.eye, -up});
  if (!below) return;
  if (state.walking_height == 0.0) state.walking_height = below->distance;
  // Only a part of the way is taken at once, so that stairs do not jolt.
  const double rise = 0.3 * (state.walking_height - below->distance);
  state.camera.eye += rise * up;
  state.camera.target += rise * up;
}

void move_camera(Session& session, const JsonPlace& action) {
  State& state = session.state();
  const double seconds = std::clamp(number_or(action, "seconds", 1.0), 0.0, 1.0);
  const double radius = bounds_of(*state.objects).radius, step = seconds * state.settings.speed * radius;
  const glm::dvec3 by =
      step * glm::dvec3(number_or(action, "right", 0.0), number_or(action, "up", 0.0), number_or(action, "ahead", 0.0));
  if (state.camera.orthographic_height) {
    // In orthographic views moving ahead shows the same, and there is no ground to start from.
    move(state.camera, {by.x, by.y, 0.0});
    zoom(state.camera, std::exp(-by.z / radius));
  } else if (state.settings.steering == Steering::walk) {
    move_level(state.camera, {by.x, 0.0, by.z});
    stay_on_ground(session);
  } else {
    move(state.camera, by);
  }
  fit(session);
}

// Makes the clicked point the target to look at and orbit around, at half its distance.
void look_at(Session& session, const JsonPlace& action) {
  State& state = session.state();
  if (!session.frame()) action.fail("nothing is open", "open a mesh first");
  const auto hit = cast_ray(*session.frame(), ray_through(state.camera, place_of(action)),
                            clip_plane(state.settings.clip, *state.objects));
  if (!hit) return;
  state.camera.eye += hit->point - state.camera.target;
  state.camera.target = hit->point;
  zoom(state.camera, 0.5);
  fit(session);
}

void turn_up(Session& session, const JsonPlace& action) {
  State& state = session.state();
  const std::string axis = action.at("axis").string();
  if (axis != "y" && axis != "z")
    action.at("axis").fail(action.at("axis").text() + " is no axis that can point up", "use y or z");
  state.camera.up = axis == "y" ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
  static_cast<void>(view_from(state.camera, "front", bounds_of(*state.objects)));
  fit(session);
}

void bookmark(Session& session, const JsonPlace& action) {
  session.state().bookmarks[action.at("name").string()] = session.state().camera;
}

void go_to(Session& session, const JsonPlace& action) {
  State& state = session.state();
  const auto found = state.bookmarks.find(action.at("name").string());
  if (found == state.bookmarks.end()) action.at("name").fail(action.at("name").text() + " is no bookmark");
  const ImageSize size{state.camera.width, state.camera.height};
  state.camera = found->second;
  state.camera.width = size.width;
  state.camera.height = size.height;
}

void forget(Session& session, const JsonPlace& action) {
  const JsonPlace name = action.at("name");
  if (session.state().bookmarks.erase(name.string()) == 0) name.fail(name.text() + " is no bookmark");
}

}  // namespace

std::span<const Command> camera_commands() {
  const Parameter right{"right", "degrees"}, up{"up", "degrees"}, name{"name", "text"};
  static const std::vector<Command> commands = {
      {"camera",
       "Camera",
       "Put the camera somewhere; what is not given stays",
       {{"eye", "x, y, z", false},
        {"target", "x, y, z", false},
        {"up", "x, y, z", false},
        {"fov_y_deg", "vertical angle, in perspective", false},
        {"orthographic_height", "world units from the bottom to the top of the picture, in place of the angle", false},
        {"near", "distance of the near plane", false},
        {"far", "distance of the far plane", false}},
       camera},
      {"orthographic",
       "Orthographic",
       "Switch between orthographic and perspective projection; the target keeps its size",
       {{"on", "true or false; toggled if left out", false}},
       switch_orthographic},
      {"picture_size",
       "Picture size",
       "Draw at a fixed size in pixels, or at that of the window if none is given",
       {{"width", "pixels", false}, {"height", "pixels", false}},
       picture_size},
      {"frame_all", "Frame all", "Fit the whole scene into the view", {}, frame_all},
      {"frame_selected", "Frame selected", "Fit the selected object into the view", {}, frame_selected},
      {"view_from", "View from", "Look along an axis", {{"side", "front, back, left, right, top, bottom"}}, look_along},
      {"orbit", "Orbit", "Turn the camera around its target", {right, up}, orbit_camera, false},
      {"look", "Look around", "Turn the camera in place", {right, up}, look, false},
      {"pan",
       "Pan",
       "Move camera and target parallel to the picture",
       {{"right", "share of the width"}, {"up", "share of the height"}},
       pan_camera,
       false},
      {"zoom",
       "Zoom",
       "Move towards the point under the cursor, or away from it",
       {{"factor", "of the distance; below 1 is nearer"}, {"x", "in [0, 1]", false}, {"y", "in [0, 1]", false}},
       zoom_camera,
       false},
      {"move",
       "Move",
       "Fly or walk with the camera",
       {{"right", "times the speed", false},
        {"up", "times the speed", false},
        {"ahead", "times the speed", false},
        {"seconds", "of movement, up to 1", false}},
       move_camera,
       false},
      {"look_at",
       "Look at",
       "Make the point under the cursor the target and go half the way to it",
       {{"x", "in [0, 1]", false}, {"y", "in [0, 1]", false}},
       look_at},
      {"turn_up", "Up axis", "Choose the axis that points up", {{"axis", "y or z"}}, turn_up},
      {"bookmark", "Bookmark", "Save this view under a name", {name}, bookmark},
      {"go_to", "Go to", "Go back to a bookmark", {name}, go_to},
      {"forget", "Forget", "Remove a bookmark", {name}, forget},
  };
  return commands;
}

}  // namespace occlod::viewer
