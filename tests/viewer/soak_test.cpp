// The same things again and again: nothing piles up.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <iostream>

#include "viewer/window_support.h"

namespace occlod::viewer::test {
namespace {

class Soak : public WindowTest {
 protected:
  // Something is open all the time, so that what has been closed must be let go one by one.
  void one_round() {
    act({{"do", "open"}, {"file", folder_.path("planet.json").string()}});
    for (const char* by : {"level", "visibility", "outcome", "age", "plain"}) set("color_by", by);
    set("compare", true);
    set("birdseye", true);
    set("occluder", true);
    set("occlusion", "gl-query");
    for (int i = 0; i < 3; ++i) act({{"do", "orbit"}, {"right", 20}, {"up", 2}});
    act({{"do", "orthographic"}});
    set("occlusion", "auto");
    for (int i = 0; i < 3; ++i) act({{"do", "orbit"}, {"right", -20}, {"up", -2}});
    set("budget", 5000);
    act({{"do", "pick"}, {"x", 0.5}, {"y", 0.8}});
    act({{"do", "orthographic"}});
    act({{"do", "reset"}});
    act({{"do", "close"}, {"object", session().state().objects->back().id}});
  }
};

int all_gl_objects() {
  int all = 0;
  for (const auto& [kind, count] : count_gl_objects()) all += count;
  return all;
}

// OCCLOD_SOAK_S: for so many seconds, with a line of numbers every ten rounds. Memory: the heap's own unevenness is a
// few MB in the first rounds.
TEST_F(Soak, ObjectsAndMemoryStay) {
  start();
  const char* wanted = std::getenv("OCCLOD_SOAK_S");
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(wanted != nullptr ? std::atoi(wanted) : 0);
  for (int i = 0; i < 2; ++i) one_round();
  const std::map<std::string, int> objects = count_gl_objects();
  const double memory = resident_memory_mb();
  for (int i = 1; i <= 2 || std::chrono::steady_clock::now() < end; ++i) {
    one_round();
    if (wanted == nullptr || i % 10 != 0) continue;
    std::cout << i << " rounds, " << session().figures().at("pictures") << " pictures: " << resident_memory_mb()
              << " MB, " << all_gl_objects() << " OpenGL objects" << std::endl;
  }
  EXPECT_EQ(count_gl_objects(), objects);
  EXPECT_LT(resident_memory_mb(), memory + 24.0);
  EXPECT_EQ(session().state().errors, 0);
}

}  // namespace
}  // namespace occlod::viewer::test
