// Turns mouse and keys over the view into actions.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "panels.h"

namespace occlod::viewer {

class ViewInput {
 public:
  // Call this after ImGui::NewFrame. `held` has the keys that move the camera, right, up and ahead, each -1, 0 or 1.
  void update(Panels& panels, const Layout& layout, const glm::dvec3& held, double seconds);
  // Returns whether the mouse is down on the view, or a key moves the camera.
  [[nodiscard]] bool is_busy() const noexcept { return button_ >= 0 || moves_; }

 private:
  void press(Panels& panels, const Layout& layout);
  void drag(Panels& panels, const ImVec2& by);
  void release(Panels& panels);
  void wheel(Panels& panels, const Layout& layout, float notches);

  int button_ = -1;  // pressed on the view; -1: none
  bool moved_ = false;
  bool drags_object_ = false;
  bool moves_ = false;
  ImVec2 start_{0.0F, 0.0F};
  Area picture_;  // in which it was pressed
};

// Handles a key of key_bindings(), or one that needs a name: bookmarks, paths, screenshots, dialogues.
void press_key(Panels& panels, int key, int mods);

}  // namespace occlod::viewer
