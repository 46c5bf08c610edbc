// No control that a script cannot drive, and nothing that only a script can.
#include <gtest/gtest.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <set>

#include "command.h"
#include "panels/keys.h"
#include "setting_table.h"
#include "viewer/window_support.h"

namespace occlod::viewer::test {
namespace {

class Controls : public WindowTest {};

// Those that are done over the view, by the mouse or by keys that need no table.
const std::set<std::string> by_mouse_and_keys = {"orbit",   "look", "pan",  "zoom",   "move",
                                                 "look_at", "drag", "pick", "measure"};

TEST_F(Controls, EverySettingAndCommandHasOne) {
  start(planet_scene());  // large enough for "cancel" to be seen while it is built
  Panels& panels = application_->panels();
  panels.unfold = true;
  draw(3);
  act({{"do", "wait_no_such"}});  // a notice, which "dismiss" hides
  act({{"do", "pick"}, {"x", 0.5}, {"y", 0.9}});
  draw(2);
  const std::set<std::string> while_stopped = panels.drawn;
  act({{"do", "record"}, {"name", "mine"}});  // instead of "record" there is "stop"
  draw(2);
  EXPECT_TRUE(panels.drawn.contains("stop"));

  act({{"do", "close_all"}});  // with nothing open there are the panels of meshes and of HLODs
  draw(2);
  std::set<std::string> reachable = panels.drawn;
  reachable.insert(while_stopped.begin(), while_stopped.end());
  reachable.insert(by_mouse_and_keys.begin(), by_mouse_and_keys.end());
  for (const KeyBinding& binding : key_bindings()) {
    reachable.insert(binding.action.at("do").get<std::string>());
    if (binding.action.contains("setting")) reachable.insert(binding.action.at("setting").get<std::string>());
  }
  for (const Setting* setting : all_settings()) EXPECT_TRUE(panels.drawn.contains(setting->name)) << setting->name;
  for (const Command* command : all_commands()) EXPECT_TRUE(reachable.contains(command->name)) << command->name;
  for (const std::string& name : reachable)
    EXPECT_TRUE(find_setting(name) != nullptr || find_command(name) != nullptr) << name;
}

TEST_F(Controls, KeysPerformTheirActions) {
  start();
  for (const KeyBinding& binding : key_bindings()) {
    const std::string command = binding.action.at("do").get<std::string>();
    if (command == "quit" || command == "close") continue;
    act({{"do", "frame_all"}});
    act({{"do", "pick"}, {"x", 0.5}, {"y", 0.5}});
    const int errors = session().state().errors;
    press_key(application_->panels(), binding.key, binding.mods);
    draw(2);
    EXPECT_EQ(session().state().errors, errors) << binding.keys;
  }
  act({{"do", "reset"}});
  const std::size_t budget = session().state().settings.refine.budget;
  press_key(application_->panels(), '=', 0);
  EXPECT_EQ(session().state().settings.refine.budget, 2 * budget);
}

// What is typed from the key that opens the dialogue on is its path, and nothing of it a key of the view.
TEST_F(Controls, TheOpenDialogueTakesTheKeyboard) {
  start();
  const auto file = folder_.write("xp.json", planet_scene(3));
  const bool wire = session().state().settings.look.wire;
  for (const bool drawn : {false, true}) {
    press(GLFW_KEY_O, GLFW_MOD_CONTROL);
    if (drawn) draw(3);
    type("xp");
    EXPECT_TRUE(session().state().captures.empty());
    draw(3);
    EXPECT_EQ(session().state().settings.look.wire, wire);
    EXPECT_EQ(application_->panels().fields.open_file, "xp");
    type(" z");
    draw(2);
    EXPECT_EQ(application_->panels().fields.open_file, "xp z");
    press(GLFW_KEY_ESCAPE);
    draw(2);
    EXPECT_FALSE(application_->panels().fields.opens);
    type("x");  // for the view again
    draw(2);
    EXPECT_NE(session().state().settings.look.wire, wire);
    type("x");
    draw(2);
  }
  press(GLFW_KEY_O, GLFW_MOD_CONTROL);
  type(file.string());
  draw(3);
  press(GLFW_KEY_ENTER, 0, true);
  draw(3);
  while (!session().settled()) draw();
  EXPECT_EQ(session().state().objects->size(), 2U) << application_->panels().fields.open_file;
  EXPECT_EQ(session().state().errors, 0);
}

TEST_F(Controls, KeysWithoutAnythingToActOnSaySo) {
  start({{"objects", {{{"generator", "rough-planet"}, {"options", {{"level", 3}}}}}}});
  for (const int key : {GLFW_KEY_1, GLFW_KEY_SPACE}) {
    act({{"do", "dismiss"}});
    press(key);
    ASSERT_EQ(session().state().notices.size(), 1U) << key;
    EXPECT_FALSE(session().state().notices[0].is_error);
  }
}

TEST_F(Controls, EscapeClosesTheHelpThenThePick) {
  start();
  act({{"do", "pick"}, {"x", 0.5}, {"y", 0.9}});
  ASSERT_TRUE(session().state().pick);
  press(GLFW_KEY_F1);
  draw(2);
  ASSERT_TRUE(session().state().settings.window.help);
  press(GLFW_KEY_ESCAPE);
  draw(2);
  EXPECT_FALSE(session().state().settings.window.help);
  EXPECT_TRUE(session().state().pick);
  press(GLFW_KEY_ESCAPE);
  draw(2);
  EXPECT_FALSE(session().state().pick);
}

}  // namespace
}  // namespace occlod::viewer::test
