// Ways of looking, against pictures that were looked at. OCCLOD_UPDATE_GOLDEN=1 writes them anew: look at them then.
#include "viewer/golden.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <glm/common.hpp>

#include "occlod/generate.h"
#include "occlod/mesh_file.h"
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
  TriangleMesh mesh = generate("rough-planet", {{"level", 5}});
  for (const glm::vec3& p : mesh.positions)
    mesh.colors.emplace_back(glm::clamp(127.0F + 120.0F * p, 0.0F, 255.0F), 255);
  write_mesh(folder_.path("coloured.ply"), mesh);
  act({{"do", "close_all"}});
  act({{"do", "open"}, {"file", folder_.path("coloured.ply").string()}});
  act({{"do", "view_from"}, {"side", "front"}});
  set("color_by", "vertices");
  expect_golden("vertices");
}

// A square with an image of four colours, each in its corner of the picture: no golden picture is needed to tell.
TEST_F(Golden, Textures) {
  Image four{2, 2, {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 255, 255}}};
  write_png(folder_.path("four.png"), four);
  std::ofstream(folder_.path("square.mtl")) << "newmtl four\nmap_Kd four.png\n";
  std::ofstream(folder_.path("square.obj")) << "mtllib square.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
                                               "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                                               "usemtl four\nf 1/1 2/2 3/3 4/4\n";
  act({{"do", "close_all"}});
  act({{"do", "open"}, {"file", folder_.path("square.obj").string()}});
  act({{"do", "view_from"}, {"side", "front"}});
  const Image textured = picture();
  const auto at = [&](const Image& image, int x, int y) { return image.pixels[static_cast<std::size_t>(200 * y + x)]; };
  const glm::u8vec4 red = at(textured, 75, 50), green = at(textured, 125, 50), blue = at(textured, 75, 100),
                    white = at(textured, 125, 100);
  EXPECT_TRUE(red.x > 2 * red.y && red.x > 2 * red.z) << int{red.x} << " " << int{red.y} << " " << int{red.z};
  EXPECT_TRUE(green.y > 2 * green.x && green.y > 2 * green.z);
  EXPECT_TRUE(blue.z > 2 * blue.x && blue.z > 2 * blue.y);
  EXPECT_TRUE(white.x > 100 && white.y > 100 && white.z > 100);
  set("color_by", "plain");
  EXPECT_EQ(at(picture(), 75, 50), at(picture(), 125, 100));
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
