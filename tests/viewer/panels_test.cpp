// What panels say. Dear ImGui alone, without a window: its log has all text that is drawn.
#include "panels/panels.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <string>

#include "examples.h"
#include "viewer/support.h"

namespace occlod::viewer::test {
namespace {

class PanelTexts : public ::testing::Test {
 protected:
  PanelTexts() {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = ImVec2(1160.0F, 3000.0F);
    io.DeltaTime = 0.5F;
    io.IniFilename = nullptr;
    io.ClipboardUserData = &text_;
    io.SetClipboardTextFn = [](void* text, const char* copied) { *static_cast<std::string*>(text) = copied; };
    unsigned char* pixels = nullptr;
    int width = 0;
    int height = 0;
    io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    session_.set_view_size({320, 240});
  }
  PanelTexts(const PanelTexts&) = delete;
  PanelTexts& operator=(const PanelTexts&) = delete;
  ~PanelTexts() override { ImGui::DestroyContext(); }

  // Draws everything three times, so that the panels have their final places.
  void draw_all() {
    for (int i = 0; i < 3; ++i) {
      ImGui::NewFrame();
      panels_.drawn.clear();
      draw_panels(panels_, lay_out(session_, ImGui::GetIO().DisplaySize, 1.0F), {});
      ImGui::EndFrame();
    }
  }
  // Returns the text of one panel with the mouse there, up to its help if that is shown.
  std::string text_of(const std::function<void()>& draw, const ImVec2& mouse = ImVec2(-1.0F, -1.0F)) {
    for (int i = 0; i < 3; ++i) {
      ImGui::GetIO().MousePos = mouse;
      ImGui::NewFrame();
      ImGui::SetNextWindowPos(ImVec2(0.0F, 0.0F));
      ImGui::SetNextWindowSize(ImVec2(800.0F, 150.0F));
      ImGui::Begin("panel", nullptr, ImGuiWindowFlags_NoDecoration);
      ImGui::LogToClipboard();
      draw();
      ImGui::LogFinish();
      ImGui::End();
      ImGui::EndFrame();
    }
    return text_;
  }
  [[nodiscard]] std::string numbers(const ImVec2& mouse = ImVec2(-1.0F, -1.0F)) {
    return text_of([&] { draw_numbers(panels_, {ImVec2(0.0F, 0.0F), ImVec2(800.0F, 150.0F)}); }, mouse);
  }
  void open_planet() {
    act(session_, {{"do", "open"}, {"file", folder_.write("planet.json", planet_scene()).string()}});
  }

  Folder folder_;
  Session session_{make_portable_visibility, false};
  Panels panels_{session_, {}, 1.0F, {}, false, {}};
  std::string text_;
};

// Of the settings only those that are needed first; the others are in sections that are folded.
TEST_F(PanelTexts, LittleIsShownBeforeAnythingIsOpen) {
  draw_all();
  const std::set<std::string> expected = {"budget", "compare",      "close_all", "forget_recent", "freeze", "occlusion",
                                          "open",   "open_example", "set"};
  EXPECT_EQ(panels_.drawn, expected);
  panels_.unfold = true;
  draw_all();
  EXPECT_TRUE(panels_.drawn.contains("hysteresis"));
}

// Every example opens with a path to play, is replaced by nothing else, and leaves no trace among the recent files.
TEST_F(PanelTexts, ExamplesNeedNoFile) {
  for (const Example& example : examples()) {
    act(session_, {{"do", "open_example"}, {"name", example.name}});
    ASSERT_FALSE(session_.state().objects->empty()) << session_.state().notices.back().text;
    EXPECT_EQ(are_hlods(*session_.state().objects), example.as == LoadAs::hlod);
    EXPECT_EQ(session_.state().paths.size(), 1U) << example.name;
    EXPECT_EQ(session_.state().about, example.about);
    draw_all();
    EXPECT_FALSE(panels_.drawn.contains("open_example"));
    act(session_, {{"do", "close_all"}});
  }
  EXPECT_TRUE(session_.state().recent.empty());
  session_.perform(nlohmann::json{{"do", "open_example"}, {"name", "bunny"}});
  EXPECT_NE(session_.state().notices.back().text.find("use one of: planet, city, plant, city-hlod"), std::string::npos);
}

// The bound is many times the error that is seen, so it comes second, by its name.
TEST_F(PanelTexts, TheErrorComesBeforeItsBound) {
  open_planet();
  act(session_, {{"do", "set"}, {"setting", "budget"}, {"value", 2000}});
  const auto figures = session_.figures();
  const double error = figures.at("max_quadric_error_px"), bound = figures.at("max_error_px");
  EXPECT_LT(3.0 * error, bound);
  char expected[2][40];
  std::snprintf(expected[0], sizeof expected[0], "%.2f px", error);
  std::snprintf(expected[1], sizeof expected[1], "%.2f px", bound);
  const std::string text = numbers();
  std::size_t at = 0;
  for (const char* words :
       {"largest error", static_cast<const char*>(expected[0]), "its bound", static_cast<const char*>(expected[1])}) {
    at = text.find(words, at);
    ASSERT_NE(at, std::string::npos) << words << " in " << text;
  }
  const std::string csv = folder_.path("numbers.csv").string();
  act(session_, {{"do", "export_csv"}, {"file", csv}});
  EXPECT_NEAR(session_.timeline().records().back().max_quadric_error_px, error, 1e-9);
}

// Labels and numbers explain themselves where the mouse is, not only the control beside them.
TEST_F(PanelTexts, LabelsAndNumbersHaveHelp) {
  open_planet();
  const auto is_shown = [&](const std::string& help, const std::function<std::string(const ImVec2&)>& look) {
    for (float y = 0.0F; y < 150.0F; y += 8.0F)
      if (look(ImVec2(20.0F, y)).find(help) != std::string::npos) return true;
    return false;
  };
  EXPECT_TRUE(is_shown("the mesh never has more",
                       [&](const ImVec2& mouse) { return text_of([&] { draw_first(panels_); }, mouse); }));
  EXPECT_TRUE(is_shown("about the root mean square", [&](const ImVec2& mouse) { return numbers(mouse); }));
}

}  // namespace
}  // namespace occlod::viewer::test
