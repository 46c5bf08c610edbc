// Implements the commands that record, replay and export camera paths.
#include <filesystem>

#include "command.h"
#include "occlod/base.h"
#include "session.h"

namespace occlod::viewer {
namespace {

const CameraPath& path_at(const Session& session, const JsonPlace& place) {
  const auto found = session.state().paths.find(place.string());
  if (found == session.state().paths.end())
    place.fail('"' + place.string() + "\" is not a camera path", "record it first, or open its scene");
  return found->second;
}

void record(Session& session, const JsonPlace& action) {
  if (session.state().objects->empty()) action.fail("nothing is open", "open a mesh first");
  session.state().playback = {};
  session.state().recording = {action.at("name").string(), {{session.state().camera}, 1}, 0.0, false};
}

// Ends the recording, which becomes a path, and the playback.
void stop(Session& session, const JsonPlace&) {
  State& state = session.state();
  state.playback = {};
  if (state.recording.path.empty()) return;
  CameraPath path = std::move(state.recording.keys);
  path.frames = static_cast<int>(path.keys.size());
  state.paths[state.recording.path] = std::move(path);
  state.recording = {};
}

void play(Session& session, const JsonPlace& action) {
  static_cast<void>(path_at(session, action.at("name")));
  session.state().recording = {};
  session.state().playback = {action.at("name").string(), 0.0, {}, false};
}

void picture_sequence(Session& session, const JsonPlace& action) {
  const CameraPath& path = path_at(session, action.at("name"));
  const std::filesystem::path folder = action.at("folder").string();
  std::vector<std::filesystem::path> pictures;
  for (int frame = 0; frame < path.frames; ++frame) pictures.push_back(frame_file(folder, frame));
  session.files().add_outputs(action.at("folder"), pictures, OutputKind::picture, *session.state().objects);
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) action.at("folder").fail(failed.message(), "give a folder that can be written");
  session.state().recording = {};
  session.state().playback = {action.at("name").string(), 0.0, folder, false};
}

// Shows one frame of a path without playing it.
void seek(Session& session, const JsonPlace& action) {
  const CameraPath& path = path_at(session, action.at("name"));
  const int frame = action.at("frame").integer(0);
  if (frame >= path.frames)
    action.at("frame").fail("is beyond the end", "the path has " + std::to_string(path.frames) + " frames");
  State& state = session.state();
  state.playback = {};
  const ImageSize size{state.camera.width, state.camera.height};
  state.camera = camera_at(path, frame);
  state.camera.width = size.width;
  state.camera.height = size.height;
}

void delete_path(Session& session, const JsonPlace& action) {
  static_cast<void>(path_at(session, action.at("name")));
  if (session.state().playback.path == action.at("name").string()) session.state().playback = {};
  session.state().paths.erase(action.at("name").string());
}

}  // namespace

std::span<const Command> path_commands() {
  const Parameter name{"name", "of a path"};
  static const std::vector<Command> commands = {
      {"record", "Record", "Record the camera as a path, 30 keys per second", {name}, record},
      {"stop", "Stop", "Stop recording or playing", {}, stop, false},
      {"play", "Play", "Play every frame of a path", {name}, play},
      {"picture_sequence",
       "Write pictures",
       "Play a path and write each frame to a PNG file in this folder",
       {name, {"folder", "path"}},
       picture_sequence},
      {"seek", "Seek", "Go to one frame of a path", {name, {"frame", "from 0"}}, seek, false},
      {"delete_path", "Delete path", "Delete a path", {name}, delete_path},
  };
  return commands;
}

}  // namespace occlod::viewer
