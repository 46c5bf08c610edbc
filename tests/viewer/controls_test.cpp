// No control that a script cannot drive, and nothing that only a script can.
#include <gtest/gtest.h>

#include <set>

#include "command.h"
#include "panels/keys.h"
#include "setting_table.h"
#include "viewer/window_support.h"

namespace occlod::viewer::test {
namespace {

class Controls : public WindowTest {};

// Those that are done over the view, by the mouse or by keys that need no table.
const std::set<std::string> by_mouse_and_keys = {"orbit", "look", "pan", "zoom", "move", "look_at", "drag", "pick"};

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

}  // namespace
}  // namespace occlod::viewer::test
