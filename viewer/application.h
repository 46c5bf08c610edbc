// Connects a session and a window: the viewer.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "draw/gpu_timer.h"
#include "draw/scene_drawing.h"
#include "panels/panels.h"
#include "panels/view_input.h"
#include "script.h"
#include "session.h"
#include "settings_file.h"
#include "window.h"

namespace occlod::viewer {

struct ApplicationOptions {
  std::vector<std::filesystem::path> files;
  std::optional<std::filesystem::path> script;
  std::filesystem::path settings_file;  // empty: remember nothing
  std::optional<ImageSize> size;        // of the window, replaces the remembered one
  std::filesystem::path calibration;    // of this machine, for the setting auto; empty: measured
  bool use_cache = true;
  std::optional<hlod::CacheOptions> paged;  // for .ohlod files, which then load meshes on demand
  bool debug_gl = false;
};

class Application {
 public:
  // Throws Error, also for a file or script that is missing or broken.
  explicit Application(const ApplicationOptions& options);
  Application(const Application&) = delete;
  Application& operator=(const Application&) = delete;
  ~Application();

  // Draws one picture. Returns false when the window is to be closed or the script has ended. Throws Error that names
  // the action of the script that failed.
  bool step();
  void run();

  [[nodiscard]] Session& session() noexcept { return *session_; }
  [[nodiscard]] Panels& panels() noexcept { return *panels_; }
  [[nodiscard]] const Window& window() const noexcept { return *window_; }

 private:
  struct Drawings;  // lives in the window's context
  class Gui;        // Dear ImGui's own context
  void read_remembered();
  void draw_pictures(const Layout& layout);
  void draw_insets();
  void resize_window();
  // Returns whether nothing has moved the panels for some pictures.
  [[nodiscard]] bool is_laid_out(const ImageSize& pixels);
  void take_captures();
  void tell_complaints();
  // Returns what was drawn, with its legend but without the panels.
  [[nodiscard]] Image picture();
  [[nodiscard]] double wait_s() const;
  [[nodiscard]] float scale() const;

  ApplicationOptions options_;
  RememberedWindow remembered_;
  bool remembers_ = false;        // there was a settings file
  bool writes_settings_ = false;  // at the end
  std::unique_ptr<Window> window_;
  std::unique_ptr<Session> session_;
  std::unique_ptr<Gui> gui_;
  std::unique_ptr<Drawings> drawings_;
  std::unique_ptr<Panels> panels_;
  ViewInput input_;
  std::optional<Script> script_;
  double last_time_ = 0.0;
  int calm_pictures_ = 0;  // drawn since something last happened
  struct Resizing {
    ImageSize size;
    double until = 0.0;  // when the window system has had enough time
  };
  std::optional<Resizing> resizing_;  // until the window has the requested size
  struct PanelsOf {
    ImageSize pixels;
    float scale = 0.0F;
    friend bool operator==(const PanelsOf&, const PanelsOf&) = default;
  };
  PanelsOf laid_out_for_;
  int laid_out_pictures_ = 0;  // drawn with the same layout while a picture with panels waits
};

}  // namespace occlod::viewer
