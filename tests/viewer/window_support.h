// The viewer in a window of the virtual display.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "application.h"
#include "viewer/support.h"

namespace occlod::viewer::test {

// A window, a session without a cache and a debug context, over the scene of support.h.
class WindowTest : public ::testing::Test {
 protected:
  void start(const nlohmann::json& scene = planet_scene(), ImageSize size = {1000, 700});
  // Performs {"do": ...} and draws until it has taken effect and every picture has been written.
  void act(const nlohmann::json& action);
  void set(const char* setting, const nlohmann::json& value);
  void draw(int pictures = 1);
  // Presses a key, and types characters, as the window system tells them. Dear ImGui sees only keys that stay down.
  void press(int key, int mods = 0, bool stays_down = false);
  void type(const std::string& characters);
  [[nodiscard]] Session& session() { return application_->session(); }

  Folder folder_;
  std::unique_ptr<Application> application_;
};

// How many objects of each kind the current context has, up to the name 4096.
[[nodiscard]] std::map<std::string, int> count_gl_objects();

}  // namespace occlod::viewer::test
