#include "script.h"

#include <gtest/gtest.h>

#include "occlod/core/error.h"
#include "viewer/support.h"

namespace occlod::viewer {
namespace {

using nlohmann::json;

class ScriptTest : public ::testing::Test {
 protected:
  // Runs to the end; the error's words, or "".
  std::string run(const json& actions) {
    session.state().errors = 0;
    try {
      Script script(folder.write("script.json", {{"actions", actions}}));
      const auto report = [&](const json& figures) { reports.push_back(figures); };
      do {
        session.update(0.01, 100.0);
        session.state().captures.clear();  // as if they had been taken
        session.picture_drawn(0.0, 0.0);
      } while (script.step(session, report));
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
  [[nodiscard]] json open() const {
    return {{"do", "open"}, {"file", folder.write("planet.json", test::planet_scene()).string()}};
  }

  test::Folder folder;
  Session session{test::make_portable_visibility, false};
  std::vector<json> reports;
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
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_GE(reports[0].at("triangles"), 1400);
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
  ASSERT_EQ(reports.size(), 7U);
  EXPECT_GE(reports[2].at("pictures").get<double>(), reports[1].at("pictures").get<double>() + 4);
  // Five frames, each drawn.
  EXPECT_GE(reports[6].at("pictures").get<double>(), reports[5].at("pictures").get<double>() + 9);
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
  EXPECT_THROW(Script(folder.write("a.json", {{"steps", json::array()}})), Error);
  EXPECT_THROW(Script(folder.write("b.json", {{"actions", json::array()}})), Error);
  EXPECT_THROW(Script(folder.write("c.json", {{"actions", {{{"do", "report"}}}}, {"more", 1}})), Error);
  EXPECT_THROW(Script(folder.path("none.json")), Error);
}

}  // namespace
}  // namespace occlod::viewer
