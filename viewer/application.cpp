#include "application.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cfloat>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include "backend.h"
#include "draw/image_drawing.h"
#include "draw/legend_image.h"
#include "draw/overlays.h"
#include "draw/render_target.h"
#include "hlod_device.h"
#include "occlod/base.h"
#include "panels/theme.h"
#include "setting_table.h"

namespace occlod::viewer {
namespace {

using Clock = std::chrono::steady_clock;

// This many pictures are drawn after something has happened, before the window sleeps.
constexpr int restless_pictures = 4;
constexpr double idle_s = 0.5;
// Dear ImGui lays out windows and tables by the sizes that their contents had in the pictures before.
constexpr int layout_pictures = 4;
// Limits the wait for a size, which a window system may refuse without notice.
constexpr double longest_resize_s = 1.0;
// Limits the wait of a picture for its mesh: small budgets never show an outdated one, large ones do not stall.
constexpr double patience_ms = 25.0;

// Most triangles of an HLOD where the CPU draws: two cores then take a fifth of a second for a picture (llvmpipe, 1160
// x 725, 2026-11-27: 425,180 triangles take 0.14 s on the device and 0.13 s in the window).
constexpr std::size_t software_triangles = 300'000;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

ImTextureID texture_id(GLuint texture) {
  return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture));  // NOLINT: Dear ImGui's way
}

// Uses the command line's names of occlusion backends.
std::unique_ptr<Visibility> make_visibility(Occlusion occlusion) {
  Settings settings;
  settings.occlusion = occlusion;
  tool::BackendOptions options;
  options.occlusion = find_setting("occlusion")->get(settings).get<std::string>();
  return tool::make_backend(options).visibility;
}

std::unique_ptr<hlod::RenderDevice> make_device(HlodDevice device) {
  return tool::make_hlod_device(name_of(device)).device;
}

Image side_by_side(const Image& left, const Image& right) {
  Image image{left.width + right.width, left.height, {}};
  for (int y = 0; y < left.height; ++y)
    for (const Image* half : {&left, &right})
      image.pixels.insert(image.pixels.end(), half->pixels.begin() + static_cast<std::ptrdiff_t>(y) * half->width,
                          half->pixels.begin() + static_cast<std::ptrdiff_t>(y + 1) * half->width);
  return image;
}

}  // namespace

struct Application::Drawings {
  explicit Drawings(const gl::Functions& gl) : scene(gl), depth(gl), difference(gl), birdseye(gl), timer(gl) {
    for (int i = 0; i < 2; ++i) sides.push_back(std::make_unique<RenderTarget>(gl));
  }

  SceneDrawing scene;
  DepthTexture depth;
  ImageDrawing difference;
  std::vector<std::unique_ptr<RenderTarget>> sides;
  RenderTarget birdseye;
  GpuTimer timer;
  PictureCost cost;
};

class Application::Gui {
 public:
  explicit Gui(GLFWwindow* window) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
  }
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;
  ~Gui() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }

  // Without a mouse nothing is hovered.
  void begin(float scale, Theme theme, bool has_mouse) {
    if (scale != scale_ || theme != theme_) {
      if (scale_ > 0.0F) ImGui_ImplOpenGL3_DestroyFontsTexture();
      apply_theme(scale, theme);
      if (scale_ > 0.0F) ImGui_ImplOpenGL3_CreateFontsTexture();
      scale_ = scale;
      theme_ = theme;
    }
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    if (!has_mouse) ImGui::GetIO().MousePos = ImVec2(-FLT_MAX, -FLT_MAX);
    ImGui::NewFrame();
  }

 private:
  float scale_ = 0.0F;
  Theme theme_ = Theme::dark;
};

Application::Application(const ApplicationOptions& options) : options_(options) {
  if (options.script) script_.emplace(*options.script);
  std::optional<Calibration> calibration;
  if (!options.calibration.empty()) calibration = read_calibration(options.calibration);
  session_ =
      std::make_unique<Session>(make_visibility, options.use_cache, std::move(calibration), make_device, options.paged);
  if (options.script) session_->files().add_input(*options.script, "the script");
  if (!options.calibration.empty()) session_->files().add_input(options.calibration, "the calibration");
  if (!options.settings_file.empty()) session_->files().add_input(options.settings_file, "the settings file");
  read_remembered();
  window_ = std::make_unique<Window>(WindowOptions{options.size.value_or(remembered_.size), options.debug_gl});
  // The window's own driver has started by now. Contexts of occlusion backends are made by another thread, which must
  // not set this then: see gl/context.h.
  setenv("LP_NUM_THREADS", "0", 0);
  panels_ = std::make_unique<Panels>(Panels{*session_, {}, 1.0F, {}, false, {}});
  // Four samples per pixel double the CPU's time. A user who has set them keeps them.
  State& state = session_->state();
  if (window_->is_software()) {
    state.defaults.look.antialias = false;
    state.defaults.hlod.most_triangles = software_triangles;
    state.settings.hlod.most_triangles = software_triangles;  // it is not kept
  }
  if (!remembers_) state.settings = state.defaults;
  window_->on_key = [this](int key, int mods) {
    calm_pictures_ = 0;
    press_key(*panels_, key, mods);
  };
  window_->on_drop = [this](const std::filesystem::path& file) { panels_->perform("open", {{"file", file.string()}}); };
  gui_ = std::make_unique<Gui>(window_->handle());
  drawings_ = std::make_unique<Drawings>(window_->functions());
  for (const std::filesystem::path& file : options.files) panels_->perform("open", {{"file", file.string()}});
  last_time_ = glfwGetTime();
}

void Application::read_remembered() {
  if (options_.settings_file.empty()) return;
  try {
    remembers_ = read_settings(options_.settings_file, *session_, remembered_);
    writes_settings_ = true;
  } catch (const Error& error) {
    session_->notify(fmt::format("{}; settings of this run are not saved", error.what()), true);
  }
}

Application::~Application() {
  if (!writes_settings_) return;
  try {
    remembered_.size = window_->size();
    write_settings(options_.settings_file, session_->state(), remembered_);
  } catch (const std::exception&) {
    // Nobody is left to be told. The next run starts like this one did.
  }
}

float Application::scale() const {
  const double wanted = session_->state().settings.window.scale;
  return static_cast<float>(std::clamp(wanted > 0.0 ? wanted : window_->content_scale(), 0.5, 4.0));
}

// Returns 0 while something is in progress. A progress bar needs few pictures.
double Application::wait_s() const {
  const State& state = session_->state();
  if (input_.is_busy() || calm_pictures_ < restless_pictures) return 0.0;
  if (session_->loader().busy()) return 0.03;
  const bool goes_on = script_ || !state.captures.empty() || !state.playback.path.empty() ||
                       !state.recording.path.empty() || !session_->settled();
  return goes_on ? 0.0 : idle_s;
}

bool Application::step() {
  const double before = glfwGetTime();
  const double wait = wait_s();
  window_->poll(wait);
  const double now = glfwGetTime();
  // The wait was shorter if an event rather than the clock ended it.
  calm_pictures_ = wait == idle_s && now - before < 0.98 * idle_s ? 0 : calm_pictures_ + 1;
  const double seconds = now - last_time_;
  last_time_ = now;

  State& state = session_->state();
  resize_window();
  const ImageSize size = window_->size();
  const ImageSize pixels = window_->picture_size();
  if (pixels.width == 0 || pixels.height == 0) return !window_->wants_to_close();  // minimised
  panels_->scale = scale();
  gui_->begin(panels_->scale, state.settings.window.theme, !script_);
  const ImVec2 window_area(static_cast<float>(size.width), static_cast<float>(size.height));
  const Layout before_picture = lay_out(*session_, window_area, panels_->scale);
  input_.update(*panels_, before_picture, window_->held_keys(), seconds);
  const double pixel_ratio = static_cast<double>(pixels.width) / size.width;
  const double parts = state.settings.compare ? 2.0 : 1.0;
  session_->set_view_size({static_cast<int>(before_picture.view.width() * pixel_ratio / parts),
                           static_cast<int>(before_picture.view.height() * pixel_ratio)});
  session_->update(seconds, patience_ms);
  const Layout layout = lay_out(*session_, window_area, panels_->scale);
  draw_pictures(layout);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  take_captures();
  tell_complaints();
  window_->swap();
  drawings_->cost.draw_ms = drawings_->timer.milliseconds();
  session_->picture_drawn(drawings_->cost);
  const auto report = [](const nlohmann::json& figures) { fmt::print("{}\n", figures.dump()); };
  if (script_ && !script_->step(*session_, report)) return false;
  return !window_->wants_to_close() && !state.wants_quit;
}

void Application::resize_window() {
  State& state = session_->state();
  if (state.wanted_window) {
    resizing_ = {*std::exchange(state.wanted_window, std::nullopt), glfwGetTime() + longest_resize_s};
    window_->resize(resizing_->size);
  }
  if (!resizing_) return;
  const ImageSize size = window_->size();
  if (size == resizing_->size || glfwGetTime() > resizing_->until) resizing_.reset();
}

void Application::tell_complaints() {
  try {
    gl::check(window_->functions(), "drawing a picture");
  } catch (const gl::ContextLost&) {
    throw;
  } catch (const Error& error) {
    session_->notify(error.what(), true);
  }
  for (const std::string& complaint : window_->take_complaints()) session_->notify("OpenGL: " + complaint, true);
}

void Application::run() {
  while (step()) {
  }
}

void Application::draw_pictures(const Layout& layout) {
  const gl::Functions& gl = window_->functions();
  const State& state = session_->state();
  const Clock::time_point start = Clock::now();
  drawings_->cost.uploaded_bytes = drawings_->scene.upload(session_->frame());
  drawings_->cost.upload_ms = ms_since(start);
  drawings_->timer.begin();
  drawings_->scene.set_clip_plane(clip_plane(state.settings.clip, *state.objects));
  std::vector<ImTextureID> pictures;
  for (std::size_t i = 0; i < layout.pictures.size(); ++i) {
    const auto& frame = session_->frame();
    if (frame && i < frame->sides.size() && frame->sides[i].difference)
      drawings_->difference.draw(*drawings_->sides[i], state.camera.width, state.camera.height,
                                 frame->sides[i].difference);
    else
      drawings_->scene.draw(*drawings_->sides[i], state.camera, i, state.settings.look, main_overlay(*session_, i));
    pictures.push_back(texture_id(drawings_->sides[i]->texture()));
  }
  draw_insets();
  drawings_->timer.end();
  const ImageSize pixels = window_->picture_size();
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl.Viewport(0, 0, pixels.width, pixels.height);
  gl.Clear(GL_COLOR_BUFFER_BIT);
  draw_panels(*panels_, layout, pictures);
}

void Application::draw_insets() {
  const State& state = session_->state();
  panels_->insets = {};
  const auto& frame = session_->frame();
  if (!frame || frame->side_count() == 0) return;
  if (state.settings.insets.birdseye) {
    LookSettings look = state.settings.look;
    look.wire = false;
    const int width = static_cast<int>(280.0F * panels_->scale);
    drawings_->scene.draw(drawings_->birdseye, birdseye_camera(*session_, width, width * 3 / 4), 0, look,
                          birdseye_overlay(*session_), SceneDrawing::Colors::seen);
    panels_->insets.birdseye = texture_id(drawings_->birdseye.texture());
  }
  if (state.settings.insets.occluder && !frame->sides.empty() && frame->sides[0].occluder) {
    drawings_->depth.show(frame->sides[0].occluder, state.settings.insets.pyramid_level);
    panels_->insets.occluder = &drawings_->depth;
  }
}

Image Application::picture() {
  const Settings& settings = session_->state().settings;
  Image image = drawings_->sides[0]->read();
  if (settings.compare) image = side_by_side(image, drawings_->sides[1]->read());
  if (settings.window.legend && !draw_legend(image, legend_of(*session_), panels_->scale))
    session_->notify(fmt::format("a picture of {} x {} pixels has no room for the legend", image.width, image.height));
  return image;
}

bool Application::is_laid_out(const ImageSize& pixels) {
  const PanelsOf panels{pixels, panels_->scale};
  laid_out_pictures_ = panels == laid_out_for_ ? laid_out_pictures_ + 1 : 1;
  laid_out_for_ = panels;
  return laid_out_pictures_ >= layout_pictures;
}

// Captures what has just been drawn, if it is what the state asks for.
void Application::take_captures() {
  State& state = session_->state();
  const auto& frame = session_->frame();
  const bool is_current = session_->settled() || (!state.playback.path.empty() && frame && session_->is_current());
  if (state.captures.empty() || !is_current || resizing_) {
    laid_out_pictures_ = 0;
    return;
  }
  const ImageSize pixels = window_->picture_size();
  const bool with_panels =
      std::any_of(state.captures.begin(), state.captures.end(), [](const Capture& c) { return c.panels; });
  if (with_panels && !is_laid_out(pixels)) return;
  for (; !state.captures.empty(); state.captures.pop_front()) {
    const Capture& capture = state.captures.front();
    try {
      write_png(capture.file,
                capture.panels ? read_pixels(window_->functions(), 0, 0, pixels.width, pixels.height) : picture());
    } catch (const gl::ContextLost&) {
      throw;
    } catch (const Error& error) {
      session_->notify(error.what(), true);
    }
  }
}

}  // namespace occlod::viewer
