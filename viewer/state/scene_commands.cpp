// Opening, placing, saving.
#include <algorithm>
#include <filesystem>
#include <glm/geometric.hpp>
#include <limits>

#include "arguments.h"
#include "command.h"
#include "navigation.h"
#include "session.h"

namespace occlod::viewer {
namespace {

// The id that an action names, by "object": an id or a name; the selected one where it names none.
std::uint64_t object_of(const Session& session, const JsonPlace& action) {
  const auto place = action.find("object");
  const Objects& objects = *session.state().objects;
  if (!place) {
    if (session.state().selected == 0) action.fail("no object is selected", "click one, or name it");
    return session.state().selected;
  }
  const auto found = std::find_if(objects.begin(), objects.end(), [&](const PlacedObject& object) {
    return place->is_string() ? object.name == place->string() : object.id == place->unsigned_integer();
  });
  if (found == objects.end()) place->fail("is no object that is open", "use its name or its number");
  return found->id;
}

void edit_object(Session& session, std::uint64_t id, const std::function<void(PlacedObject&)>& edit) {
  session.edit_objects([&](Objects& objects) {
    for (PlacedObject& object : objects)
      if (object.id == id) edit(object);
  });
}

void open(Session& session, const JsonPlace& action) { session.loader().open(action.at("file").string()); }
void cancel(Session& session, const JsonPlace&) { session.loader().cancel(); }

void close(Session& session, const JsonPlace& action) {
  const std::uint64_t id = object_of(session, action);
  session.edit_objects(
      [&](Objects& objects) { std::erase_if(objects, [&](const PlacedObject& object) { return object.id == id; }); });
  State& state = session.state();
  if (state.selected == id) state.selected = 0;
  if (state.pick && state.pick->object == id) state.pick.reset();
}

void close_all(Session& session, const JsonPlace&) {
  State& state = session.state();
  session.loader().cancel();
  session.edit_objects([](Objects& objects) { objects.clear(); });
  state.selected = 0;
  state.pick.reset();
  state.bookmarks.clear();
  state.paths.clear();
  state.playback = {};
  state.recording = {};
  state.settings.freeze = false;
  session.setting_changed();
}

void select(Session& session, const JsonPlace& action) { session.state().selected = object_of(session, action); }

void place(Session& session, const JsonPlace& action) {
  edit_object(session, object_of(session, action), [&](PlacedObject& object) {
    Placement& placement = object.placement;
    if (action.has("position")) placement.position = vector_at(action, "position");
    if (action.has("rotation")) placement.rotation_deg = vector_at(action, "rotation");
    if (const auto scale = action.find("scale")) {
      if (!(scale->number() > 0.0)) scale->fail("is not larger than 0");
      placement.scale = scale->number();
    }
    object.object_to_world = matrix_of(placement);
  });
}

// By shares of what the picture shows as far away as the object's middle: it stays under the cursor.
void drag(Session& session, const JsonPlace& action) {
  const std::uint64_t id = object_of(session, action);
  edit_object(session, id, [&](PlacedObject& object) {
    Camera camera = session.state().camera;
    const double distance = glm::length(bounds_of(object).center - camera.eye);
    camera.target = camera.eye + distance * glm::normalize(camera.target - camera.eye);
    const glm::dvec3 before = camera.eye;
    pan(camera, action.at("right").number(), action.at("up").number());
    object.placement.position += camera.eye - before;
    object.object_to_world = matrix_of(object.placement);
  });
}

void show(Session& session, const JsonPlace& action) {
  const bool shown = action.at("shown").boolean();
  edit_object(session, object_of(session, action), [&](PlacedObject& object) { object.shown = shown; });
}

void two_sided(Session& session, const JsonPlace& action) {
  const bool value = action.at("value").boolean();
  edit_object(session, object_of(session, action), [&](PlacedObject& object) { object.two_sided = value; });
}

void save_scene(Session& session, const JsonPlace& action) {
  const State& state = session.state();
  SceneDescription scene;
  scene.about = state.about;
  for (const PlacedObject& object : *state.objects)
    scene.objects.push_back({object.source, object.object_to_world, object.two_sided});
  scene.cameras = state.bookmarks;
  scene.cameras["default"] = state.camera;
  scene.paths = state.paths;
  write_scene(action.at("file").string(), scene);
  session.notify("saved " + action.at("file").string());
}

void forget_recent(Session& session, const JsonPlace&) { session.state().recent.clear(); }

}  // namespace

std::span<const Command> scene_commands() {
  const Parameter object{"object", "a name or number; the selected one when not given", false};
  static const std::vector<Command> commands = {
      {"open",
       "Open",
       "Open a mesh, a hierarchy (.olod) or a scene (.json) beside what is there",
       {{"file", "path"}},
       open},
      {"cancel", "Cancel", "Stop building", {}, cancel, false},
      {"close", "Close", "Close one object", {object}, close},
      {"close_all", "Close all", "Close everything", {}, close_all},
      {"select", "Select", "Select an object", {object}, select},
      {"place",
       "Place",
       "Move, turn or scale an object",
       {object,
        {"position", "x, y, z", false},
        {"rotation", "degrees around x, then y, then z", false},
        {"scale", "larger than 0", false}},
       place},
      {"drag",
       "Drag",
       "Move an object across the picture",
       {object, {"right", "share of the width"}, {"up", "share of the height"}},
       drag,
       false},
      {"show", "Shown", "Show an object, or leave it out", {object, {"shown", "true or false"}}, show},
      {"two_sided",
       "Two-sided",
       "Back faces of the object are seen: none is culled",
       {object, {"value", "true or false"}},
       two_sided},
      {"save_scene",
       "Save scene",
       "Write objects, bookmarks and camera paths to a scene file",
       {{"file", "path"}},
       save_scene},
      {"forget_recent", "Forget recent files", "Empty the list of recent files", {}, forget_recent, false},
  };
  return commands;
}

}  // namespace occlod::viewer
