#include "window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cstdlib>
#include <utility>

#include "occlod/base.h"

namespace occlod::viewer {
namespace {

constexpr const char* way_without = "use `occlod render`, which works without a display";

std::string& last_glfw_error() {
  static std::string text;
  return text;
}

void keep_glfw_error(int, const char* text) { last_glfw_error() = text; }

[[noreturn]] void fail(const char* subject, const std::string& problem) {
  const std::string detail = last_glfw_error().empty() ? "" : " (" + last_glfw_error() + ")";
  throw Error({subject, "", problem + detail, way_without});
}

Window& window_of(GLFWwindow* window) { return *static_cast<Window*>(glfwGetWindowUserPointer(window)); }

void key_pressed(GLFWwindow* window, int key, int /*scancode*/, int action, int mods) {
  if (action == GLFW_PRESS && window_of(window).on_key) window_of(window).on_key(key, mods);
}

void files_dropped(GLFWwindow* window, int count, const char** files) {
  for (int i = 0; i < count; ++i)
    if (window_of(window).on_drop) window_of(window).on_drop(files[i]);
}

void APIENTRY keep_complaint(GLenum, GLenum type, GLuint, GLenum severity, GLsizei, const GLchar* message,
                             const void* user) {
  if (type != GL_DEBUG_TYPE_ERROR && type != GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR && severity != GL_DEBUG_SEVERITY_HIGH)
    return;
  static_cast<std::vector<std::string>*>(const_cast<void*>(user))->emplace_back(message);
}

void listen_to_driver(const gl::Functions& gl, std::vector<std::string>& complaints) {
  const auto set_callback =
      reinterpret_cast<PFNGLDEBUGMESSAGECALLBACKPROC>(glfwGetProcAddress("glDebugMessageCallback"));
  if (set_callback == nullptr) return;
  gl.Enable(GL_DEBUG_OUTPUT);
  gl.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  set_callback(keep_complaint, &complaints);
}

}  // namespace

Window::Window(const WindowOptions& options) {
  glfwSetErrorCallback(keep_glfw_error);
  if (glfwInit() != GLFW_TRUE) fail("display", "no window can be opened");
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);  // pictures are drawn in targets and copied here
  glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, options.debug_gl ? GLFW_TRUE : GLFW_FALSE);
  // The driver is asked to report resets of the GPU, if it can; see gl::check.
  for (const int robustness : {GLFW_LOSE_CONTEXT_ON_RESET, GLFW_NO_ROBUSTNESS}) {
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, robustness);
    window_ = glfwCreateWindow(options.size.width, options.size.height, "occlod", nullptr, nullptr);
    if (window_ != nullptr) break;
  }
  if (window_ == nullptr) {
    glfwTerminate();
    fail("OpenGL", "this display has no OpenGL 3.3 core");
  }
  glfwMakeContextCurrent(window_);
  try {
    functions_ = gl::load_functions([](const char* name) { return glfwGetProcAddress(name); }, "OpenGL");
  } catch (...) {
    glfwTerminate();
    throw;
  }
  if (options.debug_gl) listen_to_driver(functions_, complaints_);
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(window_, this);
  glfwSetKeyCallback(window_, key_pressed);
  glfwSetDropCallback(window_, files_dropped);
}

Window::~Window() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

bool Window::is_software() const {
  const GLubyte* text = functions_.GetString(GL_RENDERER);  // null when the context is lost
  const std::string renderer = text != nullptr ? reinterpret_cast<const char*>(text) : "";
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "SWR"})
    if (renderer.find(name) != std::string::npos) return true;
  return false;
}

bool Window::wants_to_close() const { return glfwWindowShouldClose(window_) != 0; }

ImageSize Window::size() const {
  ImageSize size;
  glfwGetWindowSize(window_, &size.width, &size.height);
  return size;
}

ImageSize Window::picture_size() const {
  ImageSize size;
  glfwGetFramebufferSize(window_, &size.width, &size.height);
  return size;
}

double Window::content_scale() const {
  float x = 1.0F;
  float y = 1.0F;
  glfwGetWindowContentScale(window_, &x, &y);
  return static_cast<double>(x);
}

glm::dvec3 Window::held_keys() const {
  if (glfwGetKey(window_, GLFW_KEY_LEFT_CONTROL) == GLFW_PRESS ||
      glfwGetKey(window_, GLFW_KEY_RIGHT_CONTROL) == GLFW_PRESS)
    return glm::dvec3(0.0);
  const auto axis = [&](int more, int less) {
    return (glfwGetKey(window_, more) == GLFW_PRESS ? 1.0 : 0.0) -
           (glfwGetKey(window_, less) == GLFW_PRESS ? 1.0 : 0.0);
  };
  return {axis(GLFW_KEY_D, GLFW_KEY_A), axis(GLFW_KEY_E, GLFW_KEY_Q), axis(GLFW_KEY_W, GLFW_KEY_S)};
}

void Window::resize(const ImageSize& size) { glfwSetWindowSize(window_, size.width, size.height); }
void Window::swap() { glfwSwapBuffers(window_); }

void Window::poll(double wait_s) {
  if (wait_s > 0.0)
    glfwWaitEventsTimeout(wait_s);
  else
    glfwPollEvents();
}

std::vector<std::string> Window::take_complaints() { return std::exchange(complaints_, {}); }

}  // namespace occlod::viewer
