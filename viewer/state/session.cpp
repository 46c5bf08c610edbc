#include "session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "command.h"
#include "navigation.h"
#include "occlod/base.h"
#include "occlod/view.h"
#include "setting_table.h"

namespace occlod::viewer {
namespace {

constexpr double recording_step_s = 1.0 / 30.0;
constexpr std::size_t most_recent = 12;
constexpr std::size_t max_notices = 4;
constexpr std::size_t max_notes = 2;  // about one file

nlohmann::json key_of(const Camera& c) {
  return {c.eye.x,
          c.eye.y,
          c.eye.z,
          c.target.x,
          c.target.y,
          c.target.z,
          c.up.x,
          c.up.y,
          c.up.z,
          c.fov_y_deg,
          c.near,
          c.far,
          c.width,
          c.height,
          c.orthographic_height.value_or(0.0),
          c.principal_point.x,
          c.principal_point.y};
}

// Returns keys that are equal exactly when jobs for the same objects are.
nlohmann::json key_of(const RefineJob& job, const Settings& settings) {
  nlohmann::json key =
      nlohmann::json::array({key_of(job.camera), job.keep_occluder, job.keep_seen, static_cast<int>(job.color_by)});
  key.push_back(static_cast<int>(job.beside));
  key.push_back(job.cells != nullptr);  // request_mesh() treats another file as a change of the objects
  for (const auto& group : {refine_settings(), hlod_settings(), cells_settings()})
    for (const Setting& setting : group) key.push_back(setting.get(settings));
  return key;
}

void check_parameters(const Command& command, const JsonPlace& action) {
  std::vector<std::string_view> keys = {"do"};
  for (const Parameter& parameter : command.parameters) keys.emplace_back(parameter.name);
  action.expect_keys(keys);
  for (const Parameter& parameter : command.parameters)
    if (parameter.required) static_cast<void>(action.at(parameter.name));
}

void tell(PictureRecord& record, const RefinedSide& side, bool is_new) {
  const RefineStats& stats = side.refinement.stats;
  if (is_new) {
    record.refine_ms = stats.refine_ms;
    record.occlusion_ms = stats.occlusion_ms;
    record.new_splits = stats.new_splits;
    record.merged_splits = stats.merged_splits;
    record.changed_triangles = stats.changed_triangles;
  }
  record.pending = stats.pending;
  record.budget = stats.budget;
  record.triangles = stats.triangles;
  record.visible_triangles = side.visible_triangles.value_or(0);
  record.splits = stats.splits;
  record.forced_splits = stats.forced_splits;
  record.queries = stats.queries;
  record.queries_hidden = stats.queries_hidden;
  record.max_error_px = stats.max_error_px;
  record.max_quadric_error_px = stats.max_quadric_error_px;
}

// The times are those of the device, which may be simulated.
void tell(PictureRecord& record, const HlodFront& front, bool is_new) {
  const hlod::FrameStats& stats = front.frame.stats;
  record.hlod = stats;
  record.times = front.frame.times;
  if (is_new) {
    record.refine_ms = std::max(record.times.frame_ms - record.times.stall_ms, 0.0);
    record.occlusion_ms = record.times.stall_ms;
  }
  record.triangles = stats.drawn_triangles;
  record.queries = stats.queries;
  record.queries_hidden = stats.hidden_nodes;
  record.max_error_px = stats.largest_sse_px;
}

// Returns "name", or the first of "name (2)", "name (3)", ... that no object has.
std::string free_name(const Objects& objects, const std::string& name) {
  const auto is_free = [&](const std::string& text) {
    return std::none_of(objects.begin(), objects.end(),
                        [&](const PlacedObject& object) { return object.name == text; });
  };
  if (is_free(name)) return name;
  for (int i = 2;; ++i)
    if (std::string text = fmt::format("{} ({})", name, i); is_free(text)) return text;
}

}  // namespace

std::filesystem::path frame_file(const std::filesystem::path& folder, int frame) {
  return folder / fmt::format("frame_{:05}.png", frame);
}

Session::Session(MakeVisibility make_visibility, bool use_cache, std::optional<Calibration> calibration,
                 MakeDevice make_device, const std::optional<hlod::CacheOptions>& paged)
    : loader_(use_cache, paged), worker_(std::move(make_visibility), std::move(calibration), std::move(make_device)) {}

void Session::perform(const JsonPlace& action) {
  const JsonPlace name = action.at("do");
  const Command* command = find_command(name.string());
  if (command == nullptr) name.fail(fmt::format("\"{}\" is no command", name.string()), "see occlod-view --actions");
  check_parameters(*command, action);
  touched_ = true;
  const Camera before = state_.camera;
  command->run(*this, action);
  if (state_.camera == before) return;
  try {
    const View check(state_.camera);
  } catch (const Error& error) {
    state_.camera = before;
    action.fail(error.diagnosis().place + " " + error.diagnosis().problem, error.diagnosis().remedy);
  }
}

void Session::perform(const nlohmann::json& action) {
  static const std::string from = "viewer";
  try {
    perform(JsonPlace(action, from));
  } catch (const Error& error) {
    const Diagnosis& d = error.diagnosis();
    notify(d.subject == from ? d.problem + (d.remedy.empty() ? "" : "; " + d.remedy) : error.what(), true);
  }
}

void Session::update(double seconds, double patience_ms) {
  now_s_ += seconds;
  for (Notice& notice : state_.notices) notice.age_s += seconds;
  take_loaded();
  go_on_playing();
  go_on_recording(seconds);
  request_mesh();
  if (requested_ > 0 && !shown_->empty()) worker_.wait_for(requested_, patience_ms);
  auto latest = worker_.latest();
  if (shown_->empty()) latest = nullptr;
  if (latest && latest != frame_ && !latest->error.empty()) notify(latest->error, true);
  if (latest && latest->cells && latest->cells->note.number > notes_told_) {
    notes_told_ = latest->cells->note.number;
    notify(latest->cells->note.line, true);
  }
  // After a failure the previous mesh is not what is asked for, so nothing is drawn.
  frame_ = std::move(latest);
  touched_ = false;
}

PictureRecord Session::record_of_frame() const {
  PictureRecord record;
  record.picture = pictures_ + 1;
  record.at_s = now_s_;
  if (!state_.playback.path.empty() && frame_->job.number == requested_)
    record.path_frame = static_cast<int>(state_.playback.at);
  record.memory_mb = resident_memory_mb();
  record.hash = frame_->hash;
  const bool is_new = drawn_ != frame_->job.number;
  if (frame_->sides.empty())
    tell(record, *frame_->hlod_sides[0].front, is_new);
  else
    tell(record, frame_->sides[0], is_new);
  if (frame_->cells) record.walked = frame_->cells->walked;
  return record;
}

void Session::picture_drawn(const PictureCost& cost) {
  if (frame_ && frame_->side_count() > 0) {
    PictureRecord record = record_of_frame();
    record.cost = cost;
    drawn_ = frame_->job.number;
    timeline_.add(record);
  }
  ++pictures_;
}

bool Session::settled() const noexcept {
  if (touched_ || loader_.busy() || !waiting_cells_.empty()) return false;
  return shown_->empty() || (is_current() && !goes_on());
}

bool Session::goes_on() const noexcept { return is_current() && frame_->goes_on && state_.playback.path.empty(); }

const Camera& Session::refine_camera() const noexcept { return state_.settings.freeze ? state_.frozen : state_.camera; }

void Session::set_view_size(const ImageSize& size) {
  view_size_ = {std::max(size.width, 1), std::max(size.height, 1)};
  const ImageSize& used = state_.fixed_size.value_or(view_size_);
  state_.camera.width = used.width;
  state_.camera.height = used.height;
}

void Session::open(const std::filesystem::path& file) {
  if (is_vlod_file(file))
    waiting_cells_.push_back(file);
  else
    loader_.open(file, state_.settings.load_as);
}

void Session::cancel_loading() {
  waiting_cells_.clear();
  loader_.cancel();
}

void Session::close_cells() {
  state_.cells.reset();
  if (std::exchange(state_.is_sized_for_cells, false)) state_.fixed_size.reset();
}

bool Session::cells_fit() const { return state_.cells && shown_ && are_of(*state_.cells, *shown_); }

void Session::edit_objects(const std::function<void(Objects&)>& edit) {
  auto objects = std::make_shared<Objects>(*state_.objects);
  edit(*objects);
  state_.objects = std::move(objects);
}

void Session::notify(const std::string& text, bool is_error) {
  state_.notices.push_back({text, is_error, 0.0, false});
  if (state_.notices.size() > max_notices) state_.notices.pop_front();
  if (is_error) ++state_.errors;
}

void Session::warn(const std::string& text) {
  notify(text);
  state_.notices.back().is_warning = true;
}

void Session::setting_changed() {
  if (state_.settings.freeze && !was_frozen_) state_.frozen = state_.camera;
  was_frozen_ = state_.settings.freeze;
  if (state_.settings.steering != Steering::walk) state_.walking_height = 0.0;
}

void Session::take_loaded() {
  while (auto file = loader_.take()) {
    if (file->cancelled)
      notify(file->file.filename().string() + ": cancelled");
    else if (!file->error.empty())
      notify(file->error, true);
    else if (file->cells)
      take_cells(file->cells);
    else
      add(*std::move(file));
  }
  if (waiting_cells_.empty() || loader_.busy()) return;
  loader_.open_cells(waiting_cells_.front(), state_.objects);
  waiting_cells_.pop_front();
}

void Session::take_cells(std::shared_ptr<const ViewCells> cells) {
  if (state_.objects->empty()) return;  // closed meanwhile
  files_.add_input(std::filesystem::absolute(cells->path), "a file of view cells that was opened");
  state_.cells = std::move(cells);
  if (state_.fixed_size || why_not_promised(*state_.cells, state_.camera).empty()) return;
  const auto fitting = promised_camera(*state_.cells, state_.camera);
  if (!fitting) return;
  state_.fixed_size = {fitting->width, fitting->height};
  state_.is_sized_for_cells = true;
  set_view_size(view_size_);
  notify(
      fmt::format("the picture is {} x {} pixels, for which the cells promise their error; Camera, Picture changes it",
                  fitting->width, fitting->height));
}

void Session::add(LoadedFile file) {
  const bool first = state_.objects->empty();
  if (!first && are_hlods(file.objects) != are_hlods(*state_.objects)) {
    const bool is_hlod = are_hlods(file.objects);
    return notify(Error({file.file.string(), "",
                         is_hlod ? "is an HLOD, and meshes are open" : "is opened as a hierarchy, and HLODs are open",
                         is_hlod ? "close them first" : "close them first, or set open_as to hlod"})
                      .what(),
                  true);
  }
  edit_objects([&](Objects& objects) {
    for (PlacedObject& object : file.objects) {
      object.id = next_id_++;
      object.name = free_name(objects, object.name);
      objects.push_back(std::move(object));
    }
  });
  for (std::size_t i = 0; i < file.notes.size() && i < max_notes; ++i) warn(file.notes[i]);
  if (file.notes.size() > max_notes)
    warn(fmt::format("{} more like this on standard error", file.notes.size() - max_notes));
  for (const auto& [name, camera] : file.cameras) state_.bookmarks[name] = camera;
  for (const auto& [name, path] : file.paths) state_.paths[name] = path;
  if (!file.about.empty()) state_.about = file.about;
  if (!file.is_example) remember(std::filesystem::absolute(file.file));
  if (!first || state_.settings.freeze) return;
  if (const auto found = file.cameras.find("default"); found != file.cameras.end()) {
    state_.camera = found->second;
  } else {
    const SceneBounds bounds = bounds_of(*state_.objects);
    state_.camera = Camera{};
    state_.camera.eye = {1.0, 1.0, 2.0};
    set_view_size(view_size_);
    viewer::frame(state_.camera, bounds);
    fit_range(state_.camera, bounds);
  }
  set_view_size(view_size_);
}

// Lists a file that was opened among the recent ones.
void Session::remember(const std::filesystem::path& file) {
  if (is_scene_file(file)) files_.add_scene(file);
  std::erase(state_.recent, file);
  state_.recent.insert(state_.recent.begin(), file);
  if (state_.recent.size() > most_recent) state_.recent.resize(most_recent);
}

// Shows each frame of a path: the next one comes when the mesh of this one was drawn and saved.
void Session::go_on_playing() {
  Playback& playback = state_.playback;
  if (playback.path.empty()) return;
  const auto found = state_.paths.find(playback.path);
  if (found == state_.paths.end()) {
    playback = {};
    return;
  }
  const bool begun = frame_ && drawn_ == requested_ && frame_->job.number == requested_ && !touched_;
  if (begun && state_.captures.empty()) {
    playback.at += playback.pictures.empty() ? state_.settings.playback_rate : 1.0;
    if (playback.at > found->second.frames - 1) {
      playback = {};
      set_view_size(view_size_);
      return;
    }
  }
  const int number = static_cast<int>(playback.at);
  const bool is_new = state_.captures.empty();
  state_.camera = camera_at(found->second, number);
  if (!playback.pictures.empty() && is_new) state_.captures.push_back({frame_file(playback.pictures, number), false});
}

void Session::go_on_recording(double seconds) {
  Recording& recording = state_.recording;
  if (recording.path.empty() || state_.objects->empty()) return;
  recording.since_key_s += seconds;
  while (recording.since_key_s >= recording_step_s) {
    recording.since_key_s -= recording_step_s;
    recording.keys.keys.push_back(recorded_key());
  }
}

// Nothing lies between orthographic and perspective cameras, so all keys get the kind of the first one.
Camera Session::recorded_key() {
  Recording& recording = state_.recording;
  Camera key = state_.camera;
  const bool parallel = recording.keys.keys.front().orthographic_height.has_value();
  if (key.orthographic_height.has_value() == parallel) return key;
  if (!std::exchange(recording.converts, true))
    notify(fmt::format("the path goes on {} as it began", parallel ? "orthographic" : "in perspective"));
  set_orthographic(key, parallel, bounds_of(*state_.objects));
  return key;
}

RefineJob Session::wanted_job() const {
  const Settings& settings = state_.settings;
  RefineJob job;
  job.number = requested_ + 1;
  job.objects = shown_;
  job.camera = refine_camera();
  job.options = settings.refine;
  job.frame_to_frame = settings.frame_to_frame;
  job.occlusion = settings.occlusion;
  job.compare = settings.compare;
  job.beside = settings.beside;
  job.count_visible = settings.count_visible || settings.compare;
  job.keep_occluder = settings.insets.occluder;
  job.keep_seen = settings.insets.birdseye;
  job.color_by = settings.look.color_by;
  job.hlod = settings.hlod;
  if (settings.cells.walk && cells_fit()) job.cells = state_.cells;
  job.walk = settings.cells;
  return job;
}

void Session::request_mesh() {
  if (shown_of_ != state_.objects || cells_of_ != state_.cells) {
    cells_of_ = state_.cells;
    shown_of_ = state_.objects;
    auto shown = std::make_shared<Objects>();
    for (const PlacedObject& object : *shown_of_)
      if (object.shown) shown->push_back(object);
    shown_ = std::move(shown);
    requested_key_ = nullptr;
  }
  if (shown_->empty()) return;
  RefineJob job = wanted_job();
  nlohmann::json key = key_of(job, state_.settings);
  Playback& playback = state_.playback;
  job.from_scratch = !playback.path.empty() && !std::exchange(playback.begun, true);
  job.again = key == requested_key_ && goes_on();
  if (key == requested_key_ && !job.again && !job.from_scratch) return;
  requested_key_ = std::move(key);
  requested_ = job.number;
  worker_.request(std::move(job));
}

}  // namespace occlod::viewer
