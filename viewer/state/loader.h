// Opens files on its own thread: reads and builds meshes, and loads hierarchies and scenes.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "examples.h"
#include "objects.h"
#include "occlod/node_store.h"
#include "occlod/scene.h"
#include "settings.h"
#include "view_cells.h"

namespace occlod::viewer {

// Holds the result of opening one file.
struct LoadedFile {
  std::filesystem::path file;  // of an example, its label
  bool is_example = false;
  std::string error;  // one line; empty: success
  bool cancelled = false;
  std::vector<PlacedObject> objects;      // without ids
  std::map<std::string, Camera> cameras;  // of a scene
  std::map<std::string, CameraPath> paths;
  std::string about;
  std::vector<std::string> notes;          // one line for each image that is left out; standard error has them too
  std::shared_ptr<const ViewCells> cells;  // of a .vlod file, which has nothing else
};

// Returns whether the name ends like that of a file that can be opened, whatever its case.
[[nodiscard]] bool can_be_opened(const std::filesystem::path& file);

struct LoadProgress {
  std::string what;   // empty: nothing is being loaded
  double done = 0.0;  // in [0, 1]
  int waiting = 0;    // number of files after it
};

class Loader {
 public:
  // `use_cache` keeps built hierarchies in the user's cache folder. `paged` loads meshes of .ohlod files on demand,
  // within the budget for each file or scene that is opened.
  explicit Loader(bool use_cache, const std::optional<hlod::CacheOptions>& paged = {});
  Loader(const Loader&) = delete;
  Loader& operator=(const Loader&) = delete;
  ~Loader();  // cancels the current work

  // Opens a file. HLODs (.ohlod), and scenes with such objects, are opened as HLODs whatever `as` is.
  void open(const std::filesystem::path& file, LoadAs as = LoadAs::hierarchy);
  // Generates a scene that is in no file.
  void open(const Example& example);
  // Opens a .vlod file for these objects.
  void open_cells(const std::filesystem::path& file, std::shared_ptr<const Objects> objects);
  void cancel();  // everything
  [[nodiscard]] LoadProgress progress() const;
  [[nodiscard]] bool busy() const;
  // Returns the oldest finished file that has not been taken.
  [[nodiscard]] std::optional<LoadedFile> take();

 private:
  void run();
  struct Wanted {
    std::filesystem::path file;
    LoadAs as = LoadAs::hierarchy;
    std::shared_ptr<const Objects> cells_of;  // for a .vlod file, else null
    const Example* example = nullptr;         // in place of a file
  };
  [[nodiscard]] LoadedFile load(const Wanted& wanted);
  void load_meshes(const SceneDescription& scene, LoadedFile& result);
  void load_as_hlods(const SceneDescription& scene, LoadedFile& result);
  void report(const std::string& what, double done);  // throws when cancelled

  bool use_cache_;
  std::optional<hlod::CacheOptions> paged_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Wanted> waiting_;
  std::deque<LoadedFile> finished_;
  LoadProgress progress_;
  bool working_ = false;
  bool end_ = false;
  std::atomic<bool> cancelled_ = false;
  std::thread thread_;
};

}  // namespace occlod::viewer
