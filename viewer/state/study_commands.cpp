// Implements the commands of looking closely: export of what is shown, turning around it, measuring, and the way back
// to the frozen camera.
#include <fmt/format.h>

#include <glm/geometric.hpp>

#include "arguments.h"
#include "base/atomic_file.h"
#include "command.h"
#include "mesh/mesh_files.h"
#include "navigation.h"
#include "occlod/mesh_file.h"
#include "pick.h"
#include "session.h"
#include "shown_mesh.h"

namespace occlod::viewer {
namespace {

void export_mesh(Session& session, const JsonPlace& action) {
  const auto& frame = session.frame();
  if (!frame || frame->side_count() == 0) action.fail("nothing is shown", "open a mesh first");
  const JsonPlace place = action.at("file");
  const std::filesystem::path file = place.string();
  check_mesh_output(file);
  std::vector<std::filesystem::path> files = {file};
  if (find_format(file) == MeshFormat::obj) files.push_back(std::filesystem::path(file).replace_extension(".mtl"));
  const auto add_outputs = [&](const std::vector<std::filesystem::path>& outputs) {
    session.files().add_outputs(place, outputs, OutputKind::mesh, *session.state().objects);
  };
  add_outputs(files);
  const TriangleMesh mesh = shown_mesh(*frame, file);
  if (mesh.triangles.empty()) action.fail("nothing is shown", "turn the camera to a mesh");
  const WriteGuard images([&](const std::filesystem::path& path) { add_outputs({path}); });
  for (const std::string& note : write_mesh(file, mesh)) session.notify(note);
  session.notify(fmt::format("wrote {}: {} triangles", file.string(), mesh.triangle_count()));
}

// Makes a path of one key for each frame, so that all of them are at the same distance from the target.
void turntable(Session& session, const JsonPlace& action) {
  State& state = session.state();
  if (state.objects->empty()) action.fail("nothing is open", "open a mesh first");
  constexpr int most_frames = 100'000;
  const auto given = action.find("frames");
  const int frames = given ? given->integer(2) : 120;
  if (frames > most_frames) given->fail("is more than 100,000");
  const SceneBounds bounds = bounds_of(*state.objects);
  CameraPath path;
  path.frames = frames;
  for (int i = 0; i < frames; ++i) {
    Camera& key = path.keys.emplace_back(state.camera);
    orbit(key, 360.0 * i / frames, 0.0);
    hold(key, bounds);
  }
  const auto name = action.find("name");
  state.paths[name ? name->string() : "turntable"] = std::move(path);
}

void to_frozen(Session& session, const JsonPlace& action) {
  State& state = session.state();
  if (!state.settings.freeze) action.fail("nothing is frozen", "freeze the refinement first");
  const ImageSize size{state.camera.width, state.camera.height};
  state.camera = state.frozen;
  state.camera.width = size.width;
  state.camera.height = size.height;
}

// Sets the next end of a distance. After both ends it begins anew.
void measure(Session& session, const JsonPlace& action) {
  State& state = session.state();
  if (!session.frame() || session.frame()->side_count() == 0) action.fail("nothing is shown", "open a mesh first");
  const auto hit = cast_ray(*session.frame(), ray_through(state.camera, place_of(action)),
                            clip_plane(state.settings.clip, *state.objects));
  if (!hit) return;
  if (state.measured.size() == 2) state.measured.clear();
  state.measured.push_back(hit->point);
}

void unmeasure(Session& session, const JsonPlace&) { session.state().measured.clear(); }

}  // namespace

std::span<const Command> study_commands() {
  static const std::vector<Command> commands = {
      {"export_mesh",
       "Export mesh",
       "Write the triangles that are shown, in world space, to a mesh file",
       {{"file", "path that ends in .ply, .obj, .glb, .off or .stl"}},
       export_mesh},
      {"turntable",
       "Turntable",
       "Make a camera path once around the target, to play or to write as pictures",
       {{"name", "of the path; turntable if left out", false}, {"frames", "120 if left out", false}},
       turntable},
      {"to_frozen", "Back to the frozen camera", "Look from where the refinement was frozen", {}, to_frozen},
      {"measure",
       "Measure",
       "Make the point under the cursor the next end of a distance",
       {{"x", "in [0, 1], from the left", false}, {"y", "in [0, 1], from the top", false}},
       measure},
      {"unmeasure", "Clear the distance", "Clear the distance that is measured", {}, unmeasure},
  };
  return commands;
}

}  // namespace occlod::viewer
