// View cells in the window: each control by script with a picture of what it changes.
#include <gtest/gtest.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cstdlib>
#include <string>
#include <tuple>

#include "setting_table.h"
#include "viewer/golden.h"
#include "viewer/window_support.h"

namespace occlod::viewer::test {
namespace {

using nlohmann::json;

class Cells : public WindowTest {
 protected:
  void SetUp() override {
    start(street_scene(), {900, 640});
    act({{"do", "wait_no_such"}});  // draws until the scene is there
    const auto file = write_street_cells(folder_, *session().state().objects);
    act({{"do", "dismiss"}});
    act({{"do", "open"}, {"file", file.string()}});
    ASSERT_TRUE(session().state().cells);
    set("antialias", false);
  }
  [[nodiscard]] Image screenshot(bool panels = false) {
    act({{"do", "screenshot"}, {"file", folder_.path("picture.png").string()}, {"panels", panels}});
    return read_png(folder_.path("picture.png"));
  }
  void expect_golden(const std::string& name) {
    const std::filesystem::path file = std::filesystem::path(OCCLOD_GOLDEN) / (name + ".png");
    const Image found = screenshot();
    if (std::getenv("OCCLOD_UPDATE_GOLDEN") != nullptr) write_png(file, found);
    EXPECT_EQ(difference(found, read_png(file)), "") << name;
  }
  static std::size_t changed(const Image& a, const Image& b) {
    EXPECT_EQ(a.pixels.size(), b.pixels.size());
    std::size_t count = 0;
    for (std::size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i)
      count += a.pixels[i] != b.pixels[i] ? 1U : 0U;
    return count;
  }
};

// Each control shows what it is set to, and each value of it can be drawn.
TEST_F(Cells, EveryControlShowsItsValue) {
  act({{"do", "picture_size"}, {"width", 120}, {"height", 90}});
  act({{"do", "window_size"}, {"width", 700}, {"height", 1000}});  // the whole panel
  set("graph", false);
  for (const Setting& setting : cells_settings()) {
    const json before = setting.get(session().state().settings);
    json values = {setting.most / 2.0, setting.most};
    if (setting.kind == Setting::Kind::toggle) values = {!before.get<bool>()};
    if (setting.kind == Setting::Kind::choice) values = setting.choices;
    const Image picture = screenshot(true);
    const int errors = session().state().errors;
    for (const json& value : values) {
      set(setting.name, value);
      EXPECT_EQ(session().state().errors, errors) << setting.name << " " << value;
    }
    EXPECT_GT(changed(screenshot(true), picture), 10U) << setting.name;
    set(setting.name, before);
  }
}

// A cell from outside: what is seen of it, what is kept beyond that, what is left out and why; and boxes of all cells.
TEST_F(Cells, FromOutside) {
  act({{"do", "picture_size"}, {"width", 240}, {"height", 180}});
  act({{"do", "go_to"}, {"name", "default"}});
  set("cells_color_by", "kept");
  expect_golden("cells_street");
  set("freeze", true);
  act({{"do", "go_to"}, {"name", "above"}});
  expect_golden("cells_drawn");
  set("cells_left_out", true);
  expect_golden("cells_left_out");
  set("cells_left_out", false);
  set("cells_color_by", "plain");
  set("cell_boxes", "triangles");
  expect_golden("cells_boxes");
}

// Where cells are drawn there is no budget and no occlusion, unless a refinement stands beside them.
TEST_F(Cells, KeysActOnWhatIsShown) {
  const Settings before = session().state().settings;
  press(GLFW_KEY_C);
  EXPECT_NE(session().state().settings.cells.color_by, before.cells.color_by);
  EXPECT_EQ(session().state().settings.look.color_by, before.look.color_by);
  for (const int key : {GLFW_KEY_O, GLFW_KEY_U, GLFW_KEY_EQUAL, GLFW_KEY_MINUS}) {
    act({{"do", "dismiss"}});
    press(key);
    ASSERT_EQ(session().state().notices.size(), 1U) << key;
    EXPECT_NE(session().state().notices[0].text.find("view cells"), std::string::npos);
  }
  const auto is_as_before = [&] {
    const Settings& now = session().state().settings;
    return std::tuple(now.occlusion == before.occlusion, now.refine.budget == before.refine.budget);
  };
  EXPECT_EQ(is_as_before(), std::tuple(true, true));
  EXPECT_FALSE(session().state().settings.insets.occluder);
  set("compare", true);
  press(GLFW_KEY_O);
  press(GLFW_KEY_EQUAL);
  EXPECT_EQ(is_as_before(), std::tuple(false, false));
  set("compare", false);
  set("walk_cells", false);
  press(GLFW_KEY_C);
  EXPECT_NE(session().state().settings.look.color_by, before.look.color_by);
}

// Without left-out faces nothing of the picture from inside is missing: it is the same with them, but for triangles so
// small that none of their pixels' centres is drawn.
TEST_F(Cells, WhatIsLeftOutIsNotMissed) {
  act({{"do", "picture_size"}, {"width", 160}, {"height", 120}});
  act({{"do", "go_to"}, {"name", "default"}});
  set("shading", "flat");
  const Image without = screenshot();
  set("cells_left_out", true);
  ASSERT_GT(session().figures().at("left_out"), 100.0);
  EXPECT_LE(changed(screenshot(), without), 5U);
}

TEST_F(Cells, SplitScreenAndInset) {
  act({{"do", "go_to"}, {"name", "default"}});
  const Image one = screenshot(true);
  set("compare", true);
  EXPECT_GT(changed(screenshot(true), one), 1000U);  // both halves say what they are
  set("compare", false);
  set("birdseye", true);
  EXPECT_GT(changed(screenshot(true), one), 5000U);
  set("birdseye", false);
  act({{"do", "pick"}, {"x", 0.5}, {"y", 0.8}});
  EXPECT_EQ(session().figures().at("picked"), 1.0);
  EXPECT_GT(changed(screenshot(true), one), 500U);  // its bounds, and its numbers
}

}  // namespace
}  // namespace occlod::viewer::test
