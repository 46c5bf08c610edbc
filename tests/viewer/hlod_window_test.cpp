// HLODs in the window: each control by script with a picture of what it changes.
#include <gtest/gtest.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cstdlib>
#include <glm/common.hpp>
#include <map>
#include <string>

#include "setting_table.h"
#include "viewer/golden.h"
#include "viewer/window_support.h"

namespace occlod::viewer::test {
namespace {

using nlohmann::json;

class Hlod : public WindowTest {
 protected:
  void SetUp() override {
    write_city(folder_);
    start(city_scene("city.ohlod"), {900, 640});
    set("device", "software");
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
  // Pixels that differ.
  static std::size_t changed(const Image& a, const Image& b) {
    EXPECT_EQ(a.pixels.size(), b.pixels.size());
    std::size_t count = 0;
    for (std::size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i)
      count += a.pixels[i] != b.pixels[i] ? 1U : 0U;
    return count;
  }
  // Pixels in which a colour differs by more values.
  static std::size_t differing_by(const Image& a, const Image& b, int values) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
      const glm::ivec4 difference = glm::abs(glm::ivec4(a.pixels[i]) - glm::ivec4(b.pixels[i]));
      count += std::max({difference.x, difference.y, difference.z}) > values ? 1U : 0U;
    }
    return count;
  }
};

// Each control shows what it is set to, and each value of it can be drawn.
TEST_F(Hlod, EveryControlShowsItsValue) {
  set("device", "software");
  act({{"do", "picture_size"}, {"width", 120}, {"height", 90}});
  act({{"do", "window_size"}, {"width", 700}, {"height", 1040}});  // the whole sidebar
  set("scale", 0.6);
  application_->panels().unfold = true;
  set("graph", false);
  for (const Setting& setting : hlod_settings()) {
    const json before = setting.get(session().state().settings);
    json values = json::array();
    if (setting.kind == Setting::Kind::choice)
      for (const char* choice : setting.choices) values.push_back(choice);
    else if (setting.kind == Setting::Kind::toggle)
      values = {!before.get<bool>()};
    else
      values = {setting.least, (setting.least + setting.most) / 2.0, setting.most};
    const Image picture = screenshot(true);
    for (const json& value : values) {
      const int errors = session().state().errors;
      set(setting.name, value);
      EXPECT_EQ(session().state().errors, errors) << setting.name << " " << value;
      const bool is_looked_at = setting.kind != Setting::Kind::choice || &value == &values.back();
      if (!is_looked_at || value == before) continue;
      EXPECT_GT(changed(screenshot(true), picture), 10U) << setting.name << " " << value;
    }
    set(setting.name, before);
  }
}

// What is drawn of a street, from above.
TEST_F(Hlod, Colours) {
  act({{"do", "picture_size"}, {"width", 240}, {"height", 180}});
  act({{"do", "go_to"}, {"name", "default"}});
  set("freeze", true);
  act({{"do", "go_to"}, {"name", "above"}});
  for (const char* by : {"level", "bias", "patch"}) {
    set("hlod_color_by", by);
    expect_golden(std::string("hlod_") + by);
  }
  set("hlod_color_by", "error");
  expect_golden("hlod_error");
}

// Turned by 100 degrees in one frame: some of what is drawn was delayed, and some queries were hidden.
TEST_F(Hlod, StatesAndBoxesAfterAStep) {
  act({{"do", "picture_size"}, {"width", 240}, {"height", 180}});
  set("settle", false);
  act({{"do", "seek"}, {"name", "by"}, {"frame", 0}});
  act({{"do", "look"}, {"right", -100}, {"up", 5}});
  EXPECT_GT(session().figures().at("delayed"), 0.0);
  EXPECT_GT(session().figures().at("wasted_queries"), 0.0);
  EXPECT_GT(session().figures().at("queries_hidden"), 0.0);
  set("freeze", true);
  act({{"do", "go_to"}, {"name", "above"}});
  set("hlod_color_by", "state");
  expect_golden("hlod_state");
  set("node_boxes", "asked");
  expect_golden("hlod_asked");
  set("hlod_color_by", "level");
  set("node_boxes", "drawn");
  expect_golden("hlod_drawn");
}

// A model looks the same whether its nodes name its image or have parts of it; these leave with the nodes that are
// drawn.
TEST_F(Hlod, NodesShowTheirOwnImages) {
  act({{"do", "picture_size"}, {"width", 200}, {"height", 200}});
  set("hlod_tolerance", 0.0);
  const auto shown = [&](const char* name, OhlodImages images) {
    act({{"do", "close_all"}});
    act({{"do", "open"}, {"file", write_sheet(folder_, name, images).string()}});
    EXPECT_EQ(session().state().errors, 0) << session().state().notices.back().text;
    return screenshot();
  };
  const Image named = shown("named.ohlod", OhlodImages::named), own = shown("own.ohlod", OhlodImages::nodes);
  // Texels are those of the model, but smaller versions of its image blend others: colours differ by a few values, also
  // where nodes meet.
  ASSERT_EQ(own.pixels.size(), named.pixels.size());
  EXPECT_EQ(differing_by(own, named, 12), 0U);
  EXPECT_LT(differing_by(own, named, 4), 10U);
  const int textures = count_gl_objects()["Texture"];
  set("hlod_color_by", "plain");
  EXPECT_GT(changed(screenshot(), own), own.pixels.size() / 8);
  EXPECT_LE(count_gl_objects()["Texture"], textures - 32);  // a node of level 0 has at most 256 of 8,192 triangles
  set("hlod_color_by", "texture");
  EXPECT_EQ(changed(screenshot(), own), 0U);
  set("wire", true);
  EXPECT_GT(changed(screenshot(), own), 30U);
  set("wire", false);
  // With a node or two, the image is blurred.
  set("hlod_tolerance", 50.0);
  EXPECT_LT(session().figures().at("drawn_nodes"), 3.0);
  EXPECT_LE(count_gl_objects()["Texture"], textures - 30);
  EXPECT_LT(differing_by(screenshot(), named, 60), own.pixels.size() / 20);
}

TEST_F(Hlod, SplitScreenOfTwoStrategies) {
  act({{"do", "picture_size"}, {"width", 160}, {"height", 120}});
  act({{"do", "go_to"}, {"name", "default"}});
  set("hlod_color_by", "bias");
  set("other_strategy", "vfc");
  set("compare", true);
  expect_golden("hlod_split_screen");
  // Both halves say what they are.
  set("compare", false);
  const Image one = screenshot(true);
  set("compare", true);
  EXPECT_GT(changed(screenshot(true), one), 1000U);
}

// From above, with the frustum; a node that is picked, with its box.
TEST_F(Hlod, InsetAndPick) {
  act({{"do", "go_to"}, {"name", "default"}});
  const Image plain = screenshot(true);
  set("birdseye", true);
  EXPECT_GT(changed(screenshot(true), plain), 5000U);
  set("birdseye", false);
  act({{"do", "pick"}, {"x", 0.5}, {"y", 0.8}});
  EXPECT_EQ(session().figures().at("picked"), 1.0);
  EXPECT_GT(changed(screenshot(true), plain), 1000U);  // its box, and its numbers
}

// Each key changes a setting of HLODs, or says why it does nothing.
TEST_F(Hlod, KeysActOnWhatIsShown) {
  const auto expect_changed = [&](int key, const char* setting) {
    const json before = find_setting(setting)->get(session().state().settings);
    press(key);
    draw(2);
    EXPECT_NE(find_setting(setting)->get(session().state().settings), before) << setting;
  };
  expect_changed(GLFW_KEY_C, "hlod_color_by");
  expect_changed(GLFW_KEY_O, "strategy");
  expect_changed(GLFW_KEY_V, "shading");
  EXPECT_EQ(session().state().settings.look.color_by, Settings().look.color_by);
  EXPECT_EQ(session().state().settings.occlusion, Settings().occlusion);
  const double tolerance = session().state().settings.hlod.traverse.tolerance_px;
  press(GLFW_KEY_EQUAL);
  EXPECT_EQ(session().state().settings.hlod.traverse.tolerance_px, tolerance / 2.0);
  press(GLFW_KEY_MINUS);
  press(GLFW_KEY_KP_SUBTRACT);
  EXPECT_EQ(session().state().settings.hlod.traverse.tolerance_px, tolerance * 2.0);
  EXPECT_EQ(session().state().settings.refine.budget, Settings().refine.budget);
  act({{"do", "dismiss"}});
  press(GLFW_KEY_U);
  ASSERT_EQ(session().state().notices.size(), 1U);
  EXPECT_NE(session().state().notices[0].text.find("HLOD"), std::string::npos);
  EXPECT_FALSE(session().state().settings.insets.occluder);
}

// OpenGL in a context of its own draws what the rasteriser draws, but for pixels at edges: about as many nodes.
TEST_F(Hlod, IsDrawnByOpenGL) {
  act({{"do", "go_to"}, {"name", "default"}});
  const double nodes = session().figures().at("drawn_nodes");
  set("device", "gl");
  ASSERT_EQ(session().state().errors, 0) << session().state().notices.back().text;
  EXPECT_NEAR(session().figures().at("drawn_nodes"), nodes, 0.1 * nodes);
  EXPECT_GT(session().figures().at("queries"), 0.0);
  EXPECT_GT(session().figures().at("frame_ms"), 0.0);
}

}  // namespace
}  // namespace occlod::viewer::test
