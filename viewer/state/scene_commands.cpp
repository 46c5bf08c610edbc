// Implements the commands that open, place and save.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <string>
#include <variant>

#include "arguments.h"
#include "command.h"
#include "mesh_names.h"
#include "navigation.h"
#include "session.h"

namespace occlod::viewer {
namespace {

// Returns the id that an action names by "object", an id or a name; that of the selected object if it names none.
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
  if (found == objects.end()) place->fail(place->text() + " is not an open object", "use its name or its number");
  return found->id;
}

void edit_object(Session& session, std::uint64_t id, const std::function<void(PlacedObject&)>& edit) {
  session.edit_objects([&](Objects& objects) {
    for (PlacedObject& object : objects)
      if (object.id == id) edit(object);
  });
}

// Tests the range for whole scenes in single precision, with room for the bounds of meshes.
bool is_usable(const glm::dmat4& matrix) {
  constexpr double most = 1e15;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!(std::abs(matrix[column][row]) <= most)) return false;
  return true;
}

void open(Session& session, const JsonPlace& action) { session.open(action.at("file").string()); }

void open_example(Session& session, const JsonPlace& action) {
  const JsonPlace name = action.at("name");
  const Example* example = find_example(name.string());
  if (example == nullptr) {
    std::string names;
    for (const Example& one : examples()) names += (names.empty() ? "" : ", ") + std::string(one.name);
    name.fail("is no example", "use one of: " + names);
  }
  session.loader().open(*example);
}

void cancel(Session& session, const JsonPlace&) { session.cancel_loading(); }

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
  session.cancel_loading();
  session.edit_objects([](Objects& objects) { objects.clear(); });
  session.close_cells();
  state.selected = 0;
  state.pick.reset();
  state.measured.clear();
  state.bookmarks.clear();
  state.paths.clear();
  state.playback = {};
  state.recording = {};
  state.settings.freeze = false;
  session.setting_changed();
}

void close_cells(Session& session, const JsonPlace&) { session.close_cells(); }

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
    if (!is_usable(object.object_to_world))
      action.fail("is out of the range of single precision", "use smaller numbers");
  });
}

// Moves an object by shares of what the picture shows at the distance of its middle: it stays under the cursor.
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
  edit_object(session, object_of(session, action), [&](PlacedObject& object) {
    object.two_sided = value;
    for (SceneObject& part : object.parts) part.two_sided = value;
  });
}

MeshSource source_in_scene(MeshSource source, const std::filesystem::path& folder) {
  if (auto* const mesh = std::get_if<MeshFile>(&source))
    for (std::string& name : mesh->names) name = name_in_scene(name, folder);
  return source;
}

void save_scene(Session& session, const JsonPlace& action) {
  const State& state = session.state();
  const JsonPlace place = action.at("file");
  if (!is_scene_file(place.string()))
    place.fail(place.string() + " would not be opened as a scene again", "let the name end in .json");
  const std::filesystem::path file = session.files().output(place, OutputKind::scene, *state.objects);
  SceneDescription scene;
  scene.about = state.about;
  for (const PlacedObject& object : *state.objects)
    for (const SceneObject& part : object.parts)
      scene.objects.push_back({source_in_scene(part.source, file.parent_path()),
                               object.object_to_world * part.object_to_world, part.two_sided, part.attributes});
  scene.cameras = state.bookmarks;
  scene.cameras["default"] = state.camera;
  scene.paths = state.paths;
  write_scene(file, scene);
  session.notify("saved " + file.string());
}

void forget_recent(Session& session, const JsonPlace&) { session.state().recent.clear(); }

}  // namespace

std::span<const Command> scene_commands() {
  const Parameter object{"object", "a name or number; the selected object if left out", false};
  static const std::vector<Command> commands = {
      {"open",
       "Open",
       "Add a mesh, a hierarchy (.olod), an HLOD (.ohlod) or a scene (.json) to what is open; or walk through cells "
       "(.vlod) of what is open",
       {{"file", "path"}},
       open},
      {"open_example",
       "Example",
       "Generate a scene, so that there is something to look at without a file",
       {{"name", "planet, city, plant or city-hlod"}},
       open_example},
      {"cancel", "Cancel", "Cancel loading and building", {}, cancel, false},
      {"close", "Close", "Close one object", {object}, close},
      {"close_all", "Close all", "Close everything", {}, close_all},
      {"close_cells", "Close cells", "Refine again instead of walking through cells", {}, close_cells},
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
       "Move an object parallel to the picture",
       {object, {"right", "share of the width"}, {"up", "share of the height"}},
       drag,
       false},
      {"show", "Shown", "Show or hide an object", {object, {"shown", "true or false"}}, show},
      {"two_sided",
       "Two-sided",
       "Treat both sides of the object's triangles as visible: no back-face culling",
       {object, {"value", "true or false"}},
       two_sided},
      {"save_scene",
       "Save scene",
       "Write objects, bookmarks and camera paths to a scene file (.json)",
       {{"file", "path"}},
       save_scene},
      {"forget_recent", "Forget recent files", "Clear the list of recent files", {}, forget_recent, false},
  };
  return commands;
}

}  // namespace occlod::viewer
