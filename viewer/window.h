// Opens a window with OpenGL 3.3 core.
#pragma once

#include <filesystem>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "gl/functions.h"
#include "session.h"

struct GLFWwindow;

namespace occlod::viewer {

struct WindowOptions {
  ImageSize size{1440, 900};
  bool debug_gl = false;  // ask for a debug context and keep its messages
};

// Only one may exist at a time. Throws Error when there is no display or no OpenGL 3.3.
class Window {
 public:
  explicit Window(const WindowOptions& options);
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
  ~Window();

  [[nodiscard]] const gl::Functions& functions() const noexcept { return functions_; }
  [[nodiscard]] GLFWwindow* handle() const noexcept { return window_; }
  // Returns whether the CPU draws OpenGL.
  [[nodiscard]] bool is_software() const;
  [[nodiscard]] bool wants_to_close() const;
  [[nodiscard]] ImageSize size() const;          // in the units of the mouse
  [[nodiscard]] ImageSize picture_size() const;  // in pixels
  [[nodiscard]] double content_scale() const;    // the display's; 1: 96 dots per inch
  [[nodiscard]] glm::dvec3 held_keys() const;    // W A S D, Q E: right, up, ahead
  void resize(const ImageSize& size);
  void swap();
  // Handles events; waits for one for at most this many seconds.
  void poll(double wait_s);
  // Returns the driver's debug messages since the last call.
  [[nodiscard]] std::vector<std::string> take_complaints();

  std::function<void(int key, int mods)> on_key;
  std::function<void(const std::filesystem::path&)> on_drop;

 private:
  GLFWwindow* window_ = nullptr;
  gl::Functions functions_;
  std::vector<std::string> complaints_;
};

}  // namespace occlod::viewer
