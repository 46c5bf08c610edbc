// The same things again and again: nothing piles up.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "viewer/window_support.h"

namespace occlod::viewer::test {
namespace {

class Soak : public WindowTest {
 protected:
  void one_round() {
    act({{"do", "open"}, {"file", folder.path("planet.json").string()}});
    for (const char* by : {"level", "visibility", "outcome", "plain"}) set("color_by", by);
    set("compare", true);
    set("birdseye", true);
    set("occluder", true);
    set("occlusion", "gl-query");
    for (int i = 0; i < 5; ++i) act({{"do", "orbit"}, {"right", 20}, {"up", 2}});
    set("budget", 5000);
    act({{"do", "pick"}, {"x", 0.5}, {"y", 0.8}});
    act({{"do", "reset"}});
    act({{"do", "close_all"}});
  }
};

// Memory: the heap's own unevenness is a few MB in the first rounds.
TEST_F(Soak, ObjectsAndMemoryStay) {
  start();
  const char* wanted = std::getenv("OCCLOD_SOAK_ROUNDS");
  const int rounds = wanted != nullptr ? std::atoi(wanted) : 3;
  for (int i = 0; i < 2; ++i) one_round();
  const std::map<std::string, int> objects = count_gl_objects();
  const double memory = resident_memory_mb();
  for (int i = 1; i <= rounds; ++i) {
    one_round();
    if (i % 10 != 0) continue;
    int all = 0;
    for (const auto& [kind, count] : count_gl_objects()) all += count;
    fmt::print("{} rounds, {:.0f} pictures: {:.1f} MB, {} OpenGL objects\n", i, session().figures().at("pictures"),
               resident_memory_mb(), all);
  }
  EXPECT_EQ(count_gl_objects(), objects);
  EXPECT_LT(resident_memory_mb(), memory + 24.0);
  EXPECT_EQ(session().state().errors, 0);
}

}  // namespace
}  // namespace occlod::viewer::test
