// Mouse and held keys become actions. Dear ImGui alone, without a window.
#include <gtest/gtest.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <glm/geometric.hpp>

#include "panels/view_input.h"
#include "viewer/support.h"

namespace occlod::viewer::test {
namespace {

class Input : public ::testing::Test {
 protected:
  Input() {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = ImVec2(800.0F, 600.0F);
    io.IniFilename = nullptr;
    unsigned char* pixels = nullptr;
    int width = 0;
    int height = 0;
    io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    layout_.view = {ImVec2(0.0F, 0.0F), ImVec2(800.0F, 600.0F)};
    layout_.pictures = {layout_.view};
    session_.set_view_size({800, 600});
    act(session_, {{"do", "open"}, {"file", folder_.write("planet.json", planet_scene()).string()}});
    act(session_, {{"do", "go_to"}, {"name", "far"}});
    frame(400.0F, 300.0F);
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;
  ~Input() override { ImGui::DestroyContext(); }

  // One picture with the mouse there.
  void frame(float x, float y, const glm::dvec3& held = glm::dvec3(0.0)) {
    ImGuiIO& io = ImGui::GetIO();
    io.MousePos = ImVec2(x, y);
    io.DeltaTime = 0.5F;  // no two clicks are a double click unless a test says so
    ImGui::NewFrame();
    input_.update(panels_, layout_, held, 0.1);
    ImGui::EndFrame();
    io.MouseWheel = 0.0F;
    settle(session_);
  }
  void drag(int button, float dx, float dy) {
    ImGui::GetIO().MouseDown[button] = true;
    frame(400.0F, 300.0F);
    frame(400.0F + dx / 2.0F, 300.0F + dy / 2.0F);
    frame(400.0F + dx, 300.0F + dy);
    ImGui::GetIO().MouseDown[button] = false;
    frame(400.0F + dx, 300.0F + dy);
  }
  [[nodiscard]] const Camera& camera() const { return session_.state().camera; }

  Folder folder_;
  Session session_{make_portable_visibility, false};
  Panels panels_{session_, {}, 1.0F, {}, false, {}};
  Layout layout_;
  ViewInput input_;
};

// The object follows the mouse: dragged to the right, the eye goes to the left.
TEST_F(Input, LeftDragOrbits) {
  const Camera before = camera();
  drag(0, 100.0F, 0.0F);
  EXPECT_EQ(camera().target, before.target);
  EXPECT_LT(camera().eye.x, before.eye.x - 0.1);
  const double height = camera().eye.y;
  drag(0, 0.0F, -60.0F);  // up
  EXPECT_LT(camera().eye.y, height - 0.1);
  EXPECT_FALSE(session_.state().pick);  // a drag is no click
  EXPECT_FALSE(input_.is_busy());
}

TEST_F(Input, RightDragAndShiftPan) {
  const Camera before = camera();
  drag(1, 80.0F, 0.0F);
  EXPECT_NEAR(glm::distance(camera().eye - camera().target, before.eye - before.target), 0.0, 1e-9);
  EXPECT_LT(camera().target.x, before.target.x);
  const Camera panned = camera();
  ImGui::GetIO().KeyShift = true;
  drag(0, -80.0F, 0.0F);
  EXPECT_NEAR(camera().target.x, before.target.x, 1e-9);
  EXPECT_NE(camera().target.x, panned.target.x);
}

TEST_F(Input, ClicksMeasureWhenThatIsOn) {
  session_.state().settings.measure = true;
  for (const float x : {380.0F, 420.0F}) {
    ImGui::GetIO().MouseDown[0] = true;
    frame(x, 300.0F);
    ImGui::GetIO().MouseDown[0] = false;
    frame(x, 300.0F);
  }
  EXPECT_EQ(session_.state().measured.size(), 2U);
  EXPECT_FALSE(session_.state().pick);
}

TEST_F(Input, ClickPicksAndDoubleClickGoesThere) {
  drag(0, 1.0F, 0.0F);  // less than a drag
  EXPECT_TRUE(session_.state().pick);
  const double before = glm::distance(camera().eye, camera().target);
  ImGui::GetIO().MouseDoubleClickTime = 10.0F;
  drag(0, 0.0F, 0.0F);
  drag(0, 0.0F, 0.0F);
  EXPECT_LT(glm::distance(camera().eye, camera().target), 0.7 * before);
  EXPECT_NEAR(glm::length(camera().target), 1.0, 0.15);  // on the surface
}

TEST_F(Input, WheelGoesNearerOrFaster) {
  const double before = glm::distance(camera().eye, camera().target);
  ImGui::GetIO().MouseWheel = 2.0F;
  frame(400.0F, 300.0F);
  EXPECT_LT(glm::distance(camera().eye, camera().target), 0.9 * before);
  act(session_, {{"do", "set"}, {"setting", "steering"}, {"value", "fly"}});
  const double speed = session_.state().settings.speed;
  ImGui::GetIO().MouseWheel = 1.0F;
  frame(400.0F, 300.0F);
  EXPECT_GT(session_.state().settings.speed, speed);
}

// Where rays are parallel, nearer is nothing: less is shown.
TEST_F(Input, OrthographicWheelAndKeysShowLess) {
  act(session_, {{"do", "orthographic"}});
  const Camera before = camera();
  ImGui::GetIO().MouseWheel = 2.0F;
  frame(400.0F, 300.0F);
  EXPECT_LT(*camera().orthographic_height, 0.9 * *before.orthographic_height);
  EXPECT_NEAR(glm::distance(camera().eye, before.eye), 0.0, 1e-9);
  const double height = *camera().orthographic_height;
  act(session_, {{"do", "set"}, {"setting", "steering"}, {"value", "fly"}});
  frame(400.0F, 300.0F, {0.0, 0.0, 1.0});
  EXPECT_LT(*camera().orthographic_height, height);
  drag(0, 100.0F, 0.0F);  // looks around
  EXPECT_NE(camera().target, before.target);
  drag(1, 80.0F, 0.0F);
  press_key(panels_, GLFW_KEY_KP_5, 0);
  settle(session_);
  EXPECT_FALSE(camera().orthographic_height);
  EXPECT_EQ(session_.state().errors, 0);
}

TEST_F(Input, ControlDragMovesTheObject) {
  ImGui::GetIO().KeyCtrl = true;
  const Camera before = camera();
  drag(0, 80.0F, 0.0F);
  EXPECT_EQ(camera().eye, before.eye);
  EXPECT_GT(session_.state().objects->at(0).placement.position.x, 0.1);
}

TEST_F(Input, HeldKeysFly) {
  act(session_, {{"do", "set"}, {"setting", "steering"}, {"value", "fly"}});
  const Camera before = camera();
  frame(400.0F, 300.0F, {0.0, 0.0, 1.0});
  const glm::dvec3 ahead = glm::normalize(before.target - before.eye);
  EXPECT_GT(glm::dot(camera().eye - before.eye, ahead), 0.01);
  const Camera flown = camera();
  drag(0, 100.0F, 0.0F);  // looks around
  EXPECT_EQ(camera().eye, flown.eye);
  EXPECT_NE(camera().target, flown.target);
}

// What is beside the view is not the view's.
TEST_F(Input, BesideThePictureNothingHappens) {
  layout_.pictures = {{ImVec2(500.0F, 0.0F), ImVec2(800.0F, 600.0F)}};
  const Camera before = camera();
  drag(0, 60.0F, 0.0F);
  EXPECT_EQ(camera().eye, before.eye);
  EXPECT_FALSE(session_.state().pick);
}

}  // namespace
}  // namespace occlod::viewer::test
