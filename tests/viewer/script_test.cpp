#include "script.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <tuple>

#include "occlod/base.h"
#include "viewer/support.h"

namespace occlod::viewer {
namespace {

using nlohmann::json;

class ScriptTest : public ::testing::Test {
 protected:
  // Runs to the end; the error's words, or "".
  std::string run(const json& actions) {
    session_.state().errors = 0;
    try {
      Script script(folder_.write("script.json", {{"actions", actions}}));
      const auto report = [&](const json& figures) { reports_.push_back(figures); };
      do {
        session_.update(0.01, 100.0);
        session_.state().captures.clear();  // as if they had been taken
        session_.picture_drawn({});
      } while (script.step(session_, report));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  // Whether running them fails at this place.
  void expect_failure(const json& actions, const std::string& place) {
    const std::string words = run(actions);
    EXPECT_NE(words.find("script.json: " + place), std::string::npos) << words;
  }
  [[nodiscard]] json open() const { return {{"do", "open"}, {"file", planet_.string()}}; }

  test::Folder folder_;
  // Written once: a session may still be reading it when the next script opens it.
  const std::filesystem::path planet_ = folder_.write("planet.json", test::planet_scene());
  Session session_{test::make_portable_visibility, false};
  std::vector<json> reports_;
};

TEST_F(ScriptTest, EveryActionSeesWhatTheOnesBeforeHaveDone) {
  EXPECT_EQ(run({open(),
                 {{"do", "expect"}, {"figure", "objects"}, {"at_least", 1}},
                 {{"do", "set"}, {"setting", "budget"}, {"value", 1000}},
                 {{"do", "expect"}, {"figure", "triangles"}, {"at_least", 900}, {"at_most", 1000}},
                 {{"do", "set"}, {"setting", "budget"}, {"value", 1500}},
                 {{"do", "expect"}, {"figure", "triangles"}, {"at_least", 1400}},
                 {{"do", "report"}}}),
            "");
  ASSERT_EQ(reports_.size(), 1U);
  EXPECT_GE(reports_[0].at("triangles"), 1400);
}

// A long script is not searched for what "/actions/17/value" was.
TEST_F(ScriptTest, ErrorsNameSettingAndValue) {
  const auto words_of = [&](const char* setting, const json& value) {
    return run({{{"do", "set"}, {"setting", setting}, {"value", value}}});
  };
  for (const auto& [setting, value, words] :
       {std::tuple("budget", json(3), "/actions/0/value: budget = 3 is not between 1000 and 10000000"),
        std::tuple("budget", json("many"), "budget = \"many\""),
        std::tuple("shading", json("round"), "shading = \"round\""),
        std::tuple("shading", json("round"), "smooth, flat"), std::tuple("wire", json(1), "wire = 1"),
        std::tuple("occluder_splits", json({5, 3}), "/actions/0/value/1: occluder_splits = [5,3]"),
        std::tuple("budgets", json(1), "\"budgets\" is not a setting")})
    EXPECT_NE(words_of(setting, value).find(words), std::string::npos) << words_of(setting, value);
  EXPECT_LT(words_of("budget", std::string(5000, 'x')).size(), 300U);
  for (const auto& [action, words] :
       {std::pair(json{{"do", "go_to"}, {"name", "home"}}, "\"home\" is no bookmark"),
        std::pair(json{{"do", "play"}, {"name", "round"}}, "\"round\" is not a camera path"),
        std::pair(json{{"do", "select"}, {"object", "cow"}}, "\"cow\" is not an open object"),
        std::pair(json{{"do", "flip"}, {"setting", "budget"}}, "budget is neither"),
        std::pair(json{{"do", "expect"}, {"figure", "speed"}}, "\"speed\" is no figure")})
    EXPECT_NE(run(json::array({action})).find(words), std::string::npos) << run(json::array({action}));
}

TEST_F(ScriptTest, RepeatsAndWaits) {
  EXPECT_EQ(run({open(),
                 {{"do", "repeat"},
                  {"times", 3},
                  {"actions",
                   {{{"do", "repeat"}, {"times", 2}, {"actions", {{{"do", "report"}}}}},
                    {{"do", "wait"}, {"for", "pictures"}, {"count", 4}}}}},
                 {{"do", "play"}, {"name", "by"}},
                 {{"do", "wait"}, {"for", "path"}},
                 {{"do", "report"}}}),
            "");
  ASSERT_EQ(reports_.size(), 7U);
  EXPECT_GE(reports_[2].at("pictures").get<double>(), reports_[1].at("pictures").get<double>() + 4);
  // Five frames, each drawn.
  EXPECT_GE(reports_[6].at("pictures").get<double>(), reports_[5].at("pictures").get<double>() + 9);
}

TEST_F(ScriptTest, FailuresNameTheAction) {
  expect_failure({{{"do", "dance"}}}, "/actions/0/do");
  expect_failure({open(), {{"do", "orbit"}, {"right", 1}}}, "/actions/1");
  expect_failure({open(), {{"do", "set"}, {"setting", "budget"}, {"value", 1}}}, "/actions/1/value");
  expect_failure({open(), {{"do", "expect"}, {"figure", "triangles"}, {"at_most", 10}}}, "/actions/1/at_most");
  expect_failure({{{"do", "report"}}, {{"do", "open"}, {"file", "nowhere.ply"}}, {{"do", "report"}}}, "/actions/1");
  expect_failure({{{"do", "open"}, {"file", "nowhere.ply"}}}, "/actions/0");  // though it is the last
  expect_failure({{{"do", "repeat"}, {"times", 2}, {"actions", {{{"do", "dance"}}}}}}, "/actions/0/actions/0/do");
  expect_failure({{{"do", "repeat"}, {"actions", {{{"do", "report"}}}}}}, "/actions/0");
  expect_failure({{{"do", "wait"}, {"for", "luck"}}}, "/actions/0/for");
}

TEST_F(ScriptTest, IsReadStrictly) {
  EXPECT_THROW(Script(folder_.write("a.json", {{"steps", json::array()}})), Error);
  EXPECT_THROW(Script(folder_.write("b.json", {{"actions", json::array()}})), Error);
  EXPECT_THROW(Script(folder_.write("c.json", {{"actions", {{{"do", "report"}}}}, {"more", 1}})), Error);
  EXPECT_THROW(Script(folder_.path("none.json")), Error);
}

}  // namespace
}  // namespace occlod::viewer
