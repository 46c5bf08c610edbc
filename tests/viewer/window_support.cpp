#include <gtest/gtest.h>

#define GLFW_INCLUDE_NONE
#include <GL/glcorearb.h>
#include <GLFW/glfw3.h>

#include <cctype>
#include <chrono>

#include "viewer/window_support.h"

namespace occlod::viewer::test {

void WindowTest::start(const nlohmann::json& scene, ImageSize size) {
  ApplicationOptions options;
  options.files = {folder_.write("planet.json", scene)};
  options.size = size;
  options.use_cache = false;
  options.debug_gl = true;
  application_ = std::make_unique<Application>(options);
  set("scale", 1.0);
  set("legend", false);  // pictures without text
}

void WindowTest::act(const nlohmann::json& action) {
  session().perform(action);
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  do {
    ASSERT_TRUE(application_->step());
    ASSERT_LT(std::chrono::steady_clock::now(), end) << action;
  } while (!session().settled() || !session().state().captures.empty());
}

void WindowTest::set(const char* setting, const nlohmann::json& value) {
  act({{"do", "set"}, {"setting", setting}, {"value", value}});
}

void WindowTest::draw(int pictures) {
  for (int i = 0; i < pictures; ++i) ASSERT_TRUE(application_->step());
}

// A callback is returned only for another one.
void WindowTest::press(int key, int mods, bool stays_down) {
  GLFWwindow* window = application_->window().handle();
  const GLFWkeyfun told = glfwSetKeyCallback(window, nullptr);
  glfwSetKeyCallback(window, told);
  told(window, key, 0, GLFW_PRESS, mods);
  if (!stays_down) told(window, key, 0, GLFW_RELEASE, mods);
}

void WindowTest::type(const std::string& characters) {
  GLFWwindow* window = application_->window().handle();
  const GLFWcharfun told = glfwSetCharCallback(window, nullptr);
  glfwSetCharCallback(window, told);
  for (const char c : characters) {
    press(std::toupper(static_cast<unsigned char>(c)));
    told(window, static_cast<unsigned char>(c));
  }
}

std::map<std::string, int> count_gl_objects() {
  std::map<std::string, int> counts;
  for (const char* kind :
       {"Buffer", "Framebuffer", "Program", "Query", "Renderbuffer", "Shader", "Texture", "VertexArray"}) {
    const auto is_one =
        reinterpret_cast<GLboolean (*)(GLuint)>(glfwGetProcAddress((std::string("glIs") + kind).c_str()));
    for (GLuint name = 1; name <= 4096; ++name) counts[kind] += is_one(name) == GL_TRUE ? 1 : 0;
  }
  return counts;
}

}  // namespace occlod::viewer::test
