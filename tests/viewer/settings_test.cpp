#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "command.h"
#include "occlod/base.h"
#include "setting_table.h"
#include "settings_file.h"
#include "viewer/support.h"

namespace occlod::viewer {
namespace {

const std::string from = "test";

void set(Settings& settings, const char* name, const nlohmann::json& value) {
  find_setting(name)->set(settings, JsonPlace(value, from));
}

// A value that differs from the default, of every kind.
nlohmann::json other_value(const Setting& setting, const nlohmann::json& value) {
  switch (setting.kind) {
    case Setting::Kind::toggle:
      return !value.get<bool>();
    case Setting::Kind::choice:
      return value == setting.choices[0] ? setting.choices[1] : setting.choices[0];
    case Setting::Kind::integer:
    case Setting::Kind::number:
      return value == setting.most ? setting.least : setting.most;
    case Setting::Kind::integers:
      return {7, 8, 9};
  }
  return nullptr;
}

TEST(SettingTable, NamesAreUniqueAndExplained) {
  std::set<std::string> names;
  for (const Setting* setting : all_settings()) {
    EXPECT_TRUE(names.insert(setting->name).second) << setting->name;
    EXPECT_NE(std::string(setting->help), "") << setting->name;
    EXPECT_EQ(find_setting(setting->name), setting);
  }
  for (const Command* command : all_commands()) {
    EXPECT_TRUE(names.insert(command->name).second) << command->name;
    EXPECT_NE(std::string(command->help), "") << command->name;
  }
}

// Each changes one field and no other setting.
TEST(SettingTable, EverySettingCanBeSetAlone) {
  for (const Setting* setting : all_settings()) {
    Settings settings;
    const nlohmann::json value = other_value(*setting, setting->get(settings));
    set(settings, setting->name, value);
    for (const Setting* other : all_settings())
      EXPECT_EQ(other->get(settings) == other->get(Settings{}), other != setting)
          << setting->name << " " << other->name;
  }
}

TEST(SettingTable, RefusesWhatDoesNotFit) {
  Settings settings;
  EXPECT_THROW(set(settings, "budget", 0), Error);
  EXPECT_THROW(set(settings, "budget", 1000.5), Error);
  EXPECT_THROW(set(settings, "budget", "10000"), Error);
  EXPECT_THROW(set(settings, "tolerance", -1), Error);
  EXPECT_THROW(set(settings, "occlusion", "magic"), Error);
  EXPECT_THROW(set(settings, "wire", 1), Error);
  EXPECT_THROW(set(settings, "occluder_splits", nlohmann::json({300, 200})), Error);
  EXPECT_NO_THROW(set(settings, "occluder_splits", nlohmann::json::array()));
  EXPECT_EQ(settings.refine.budget, RefineOptions{}.budget);
}

TEST(SettingsFile, ComesBack) {
  const test::Folder folder;
  Session before(test::make_portable_visibility, false);
  for (const Setting* setting : all_settings())
    setting->set(before.state().settings, JsonPlace(other_value(*setting, setting->get(Settings{})), from));
  before.state().recent = {"/a/b.ply", "/c.json"};
  write_settings(folder.path("sub/view.json"), before.state(), {{800, 600}});

  Session after(test::make_portable_visibility, false);
  RememberedWindow window;
  EXPECT_TRUE(read_settings(folder.path("sub/view.json"), after, window));
  for (const Setting* setting : all_settings())
    EXPECT_EQ(setting->get(after.state().settings), setting->get(setting->kept ? before.state().settings : Settings{}))
        << setting->name;
  EXPECT_EQ(after.state().recent, before.state().recent);
  EXPECT_EQ(window.size.width, 800);
}

TEST(SettingsFile, MissingIsFineAndBrokenIsNamed) {
  const test::Folder folder;
  Session session(test::make_portable_visibility, false);
  RememberedWindow window;
  EXPECT_FALSE(read_settings(folder.path("none.json"), session, window));
  const auto broken = folder.write("view.json", {{"settings", {{"budget", "many"}}}});
  try {
    static_cast<void>(read_settings(broken, session, window));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.diagnosis().subject, broken.string());
    EXPECT_EQ(error.diagnosis().place, "/settings/budget");
  }
  // Of another version.
  EXPECT_TRUE(read_settings(folder.write("new.json", {{"settings", {{"of_tomorrow", 1}}}}), session, window));
}

}  // namespace
}  // namespace occlod::viewer
