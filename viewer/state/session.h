// Implements the viewer without its window: everything that is shown, and the one way to change it. Panels, keys, the
// mouse and scripts all perform actions: {"do": COMMAND, ...parameters}, see command.h.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/strict_json.h"
#include "loader.h"
#include "objects.h"
#include "pick.h"
#include "refine_worker.h"
#include "session_files.h"
#include "settings.h"
#include "timeline.h"

namespace occlod::viewer {

struct Notice {
  std::string text;
  bool is_error = false;
  double age_s = 0.0;
  bool is_warning = false;  // no error, but to be read
};

// Names a picture to take of what is drawn next.
struct Capture {
  std::filesystem::path file;
  bool panels = false;  // the whole window; else only the view
};

struct ImageSize {
  int width = 0;
  int height = 0;
  friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

// These limits are for windows.
inline constexpr ImageSize min_window{320, 240};
inline constexpr ImageSize max_window{8192, 8192};
[[nodiscard]] constexpr bool is_window_size(const ImageSize& size) noexcept {
  return size.width >= min_window.width && size.height >= min_window.height && size.width <= max_window.width &&
         size.height <= max_window.height;
}

// Returns the name of a picture of a sequence.
[[nodiscard]] std::filesystem::path frame_file(const std::filesystem::path& folder, int frame);

// Holds the state of a camera path that is played: `at` is between 0 and its frames - 1.
struct Playback {
  std::string path;  // empty: none
  double at = 0.0;
  std::filesystem::path pictures;  // a folder, or empty
  bool begun = false;  // whether its first frame was requested: from scratch, so that each replay is the same
};

// Holds a camera path that is being recorded, one key for each time step.
struct Recording {
  std::string path;  // empty: none
  CameraPath keys;
  double since_key_s = 0.0;
  bool converts = false;  // whether the camera's projection now differs from the first key's
};

struct State {
  Settings defaults;  // to which "reset" returns
  Settings settings;
  std::shared_ptr<const Objects> objects = std::make_shared<Objects>();
  std::shared_ptr<const ViewCells> cells;  // of the objects as they were when it was opened; or null
  std::uint64_t selected = 0;              // id of an object; 0: none
  std::map<std::string, Camera> bookmarks;
  std::map<std::string, CameraPath> paths;
  std::string about;
  Camera camera;                        // of the picture; its size is kept up to date
  std::optional<ImageSize> fixed_size;  // of the picture, replaces the window's
  bool is_sized_for_cells = false;      // fixed_size is the largest that the cells were built for
  Camera frozen;                        // what is refined for while settings.freeze
  std::optional<Pick> pick;
  std::vector<glm::dvec3> measured;  // ends of the distance that is measured, world space: at most two
  Playback playback;
  Recording recording;
  double walking_height = 0.0;  // of the eye above the ground; 0: not known yet
  std::deque<Notice> notices;
  int errors = 0;  // number of notices of errors so far
  std::deque<Capture> captures;
  std::vector<std::filesystem::path> recent;
  std::optional<ImageSize> wanted_window;
  bool wants_quit = false;
};

class Session {
 public:
  // `use_cache` is for built hierarchies and HLODs. For `paged` see Loader, for the others RefineWorker.
  Session(MakeVisibility make_visibility, bool use_cache, std::optional<Calibration> calibration = {},
          MakeDevice make_device = make_portable_device, const std::optional<hlod::CacheOptions>& paged = {});

  // Throws Error that names the action's place: an unknown command or parameter, an invalid value, or something that
  // cannot be done now.
  void perform(const JsonPlace& action);
  // Performs an action of panels, keys or mouse. An error becomes a notice.
  void perform(const nlohmann::json& action);

  // Must be called before each picture. Takes what was loaded, continues playing and recording, and requests a mesh if
  // something has changed, for which it waits at most `patience_ms`.
  void update(double seconds, double patience_ms);
  // Must be called after each picture.
  void picture_drawn(const PictureCost& cost);

  [[nodiscard]] State& state() noexcept { return state_; }
  [[nodiscard]] const State& state() const noexcept { return state_; }
  [[nodiscard]] Loader& loader() noexcept { return loader_; }
  [[nodiscard]] const Loader& loader() const noexcept { return loader_; }
  [[nodiscard]] SessionFiles& files() noexcept { return files_; }
  [[nodiscard]] const Timeline& timeline() const noexcept { return timeline_; }
  // Returns the mesh to draw; null if there is none.
  [[nodiscard]] const std::shared_ptr<const RefinedFrame>& frame() const noexcept { return frame_; }
  // Returns whether nothing is being loaded, and frame() is what the state asks for, with no work left over.
  [[nodiscard]] bool settled() const noexcept;
  // Returns the numbers of frame(), which has sides, as picture_drawn() will keep them, without the costs.
  [[nodiscard]] PictureRecord record_of_frame() const;
  // Returns whether frame() is what was last asked for.
  [[nodiscard]] bool is_current() const noexcept { return frame_ && frame_->job.number == requested_; }
  [[nodiscard]] const Camera& refine_camera() const noexcept;
  // Returns all numbers by name, for panels and for scripts to check.
  [[nodiscard]] std::map<std::string, double> figures() const;

  // Sets the pixels of the view area; half of it with the split screen.
  void set_view_size(const ImageSize& size);
  void close_cells();
  // Opens a mesh, a scene etc. as the settings say. Cells are opened for what is open once everything that waits has
  // been opened.
  void open(const std::filesystem::path& file);
  void cancel_loading();
  // Returns whether cells are open, and the objects are all shown where the cells have them.
  [[nodiscard]] bool cells_fit() const;
  void edit_objects(const std::function<void(Objects&)>& edit);
  void notify(const std::string& text, bool is_error = false);
  void warn(const std::string& text);
  void setting_changed();  // call it after changing state().settings

 private:
  void take_loaded();
  void add(LoadedFile file);
  void remember(const std::filesystem::path& file);
  void take_cells(std::shared_ptr<const ViewCells> cells);
  void go_on_playing();
  void go_on_recording(double seconds);
  [[nodiscard]] Camera recorded_key();
  void request_mesh();
  [[nodiscard]] RefineJob wanted_job() const;
  // Returns whether one more frame of the same view would change something; a path has one frame for each of its
  // cameras.
  [[nodiscard]] bool goes_on() const noexcept;

  State state_;
  Loader loader_;
  RefineWorker worker_;
  Timeline timeline_;
  SessionFiles files_;
  ImageSize view_size_{1024, 768};
  std::shared_ptr<const Objects> shown_of_;    // the objects of which shown_ holds the shown ones
  std::shared_ptr<const ViewCells> cells_of_;  // cells of the last request for a mesh
  std::shared_ptr<const Objects> shown_;       // the shown objects of shown_of_
  std::deque<std::filesystem::path> waiting_cells_;
  std::uint64_t notes_told_ = 0;  // of cells that could not be loaded
  std::shared_ptr<const RefinedFrame> frame_;
  std::uint64_t requested_ = 0;  // number of the last job
  nlohmann::json requested_key_;
  std::uint64_t drawn_ = 0;     // number of the last job whose mesh was drawn
  std::uint64_t pictures_ = 0;  // number of drawn pictures
  double now_s_ = 0.0;          // since the session began
  std::uint64_t next_id_ = 1;
  bool touched_ = true;  // something was performed since the last update
  bool was_frozen_ = false;
};

}  // namespace occlod::viewer
