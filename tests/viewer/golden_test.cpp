// Ways of looking, against pictures that were looked at. OCCLOD_UPDATE_GOLDEN=1 writes them anew: look at them then.
#include "viewer/golden.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <glm/common.hpp>

#include "occlod/io/write_mesh.h"
#include "occlod/mesh/generate.h"
#include "viewer/window_support.h"

namespace occlod::viewer::test {
namespace {

class Golden : public WindowTest {
 protected:
  void SetUp() override {
    start();
    set("frame_to_frame", false);  // a picture is that of its view, whatever was looked at before
    act({{"do", "picture_size"}, {"width", 200}, {"height", 150}});
    act({{"do", "go_to"}, {"name", "far"}});
    set("budget", 1500);
    set("antialias", false);
  }
  [[nodiscard]] Image picture() {
    act({{"do", "screenshot"}, {"file", folder_.path("picture.png").string()}});
    return read_png(folder_.path("picture.png"));
  }
  void expect_golden(const std::string& name) {
    const std::filesystem::path file = std::filesystem::path(OCCLOD_GOLDEN) / (name + ".png");
    const Image found = picture();
    if (std::getenv("OCCLOD_UPDATE_GOLDEN") != nullptr) write_png(file, found);
    EXPECT_EQ(difference(found, read_png(file)), "") << name;
  }
};

TEST_F(Golden, SmoothFlatAndWire) {
  expect_golden("smooth");
  set("shading", "flat");
  expect_golden("flat");
  set("wire", true);
  expect_golden("wire");
}

// From the side of what was refined for the front: each class is in the picture.
TEST_F(Golden, Colours) {
  set("freeze", true);
  act({{"do", "orbit"}, {"right", 70}, {"up", -20}});
  for (const char* by : {"level", "error", "visibility", "outcome"}) {
    set("color_by", by);
    expect_golden(by);
  }
}

// Red to the right, green up, blue towards the eye.
TEST_F(Golden, VertexColours) {
  TriangleMesh mesh = generate_rough_planet({.level = 5});
  for (const glm::vec3& p : mesh.positions)
    mesh.colors.emplace_back(glm::clamp(127.0F + 120.0F * p, 0.0F, 255.0F), 255);
  write_mesh(folder_.path("coloured.ply"), mesh);
  act({{"do", "close_all"}});
  act({{"do", "open"}, {"file", folder_.path("coloured.ply").string()}});
  act({{"do", "view_from"}, {"side", "front"}});
  set("color_by", "vertices");
  expect_golden("vertices");
}

TEST_F(Golden, FrozenFromBehind) {
  act({{"do", "go_to"}, {"name", "default"}});
  set("color_by", "visibility");
  set("freeze", true);
  act({{"do", "go_to"}, {"name", "far"}});
  act({{"do", "orbit"}, {"right", 30}, {"up", -50}});
  expect_golden("frozen");
}

// A box, all of it, though the viewing camera's planes hold no more than the planet.
TEST_F(Golden, FrozenOrthographic) {
  act({{"do", "orthographic"}});
  expect_golden("orthographic");
  act({{"do", "zoom"}, {"factor", 0.5}, {"x", 0.7}, {"y", 0.4}});
  set("color_by", "visibility");
  set("freeze", true);
  act({{"do", "zoom"}, {"factor", 4}});
  act({{"do", "orbit"}, {"right", 50}, {"up", -30}});
  expect_golden("frozen_orthographic");
}

TEST_F(Golden, PickedSplit) {
  set("budget", 1000);
  act({{"do", "pick"}, {"x", 0.45}, {"y", 0.5}});
  expect_golden("picked");
}

TEST_F(Golden, SplitScreen) {
  act({{"do", "go_to"}, {"name", "default"}});
  set("wire", true);
  set("compare", true);
  expect_golden("split_screen");
}

// The comparison itself: it lets a driver's rounding pass, and nothing else.
TEST_F(Golden, ComparisonFailsOnEmptyAndWrongPictures) {
  const Image good = picture();
  EXPECT_EQ(difference(good, good), "");
  Image rounded = good;
  for (glm::u8vec4& pixel : rounded.pixels) pixel.x = static_cast<std::uint8_t>(pixel.x ^ 1U);
  EXPECT_EQ(difference(rounded, good), "");
  EXPECT_NE(difference(Image{}, good), "");
  Image black = good;
  black.pixels.assign(good.pixels.size(), glm::u8vec4(0, 0, 0, 255));
  EXPECT_NE(difference(black, good), "");
  set("budget", 3000);  // the same planet, finer
  EXPECT_NE(difference(picture(), good), "");
  set("budget", 1500);
  EXPECT_EQ(difference(picture(), good), "");
  act({{"do", "close_all"}});
  EXPECT_NE(difference(picture(), good), "");  // the background alone
}

}  // namespace
}  // namespace occlod::viewer::test
