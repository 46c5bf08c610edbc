// The view from above shows everything, and what was seen from the main eye.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "picture/quads.h"

namespace occlod {
namespace {

using test::front_view;
using test::pixel;
using test::Quad;

glm::dvec2 on_image(const View& view, const glm::dvec3& p) {
  const glm::dvec4 clip = view.world_to_clip() * glm::dvec4(p, 1.0);
  EXPECT_GT(clip.w, 0.0);
  EXPECT_LE(std::abs(clip.z), clip.w);
  return {(clip.x / clip.w * 0.5 + 0.5) * view.width(), (0.5 - clip.y / clip.w * 0.5) * view.height()};
}

TEST(BirdseyeCamera, SeesEverythingFromAbove) {
  const Quad near(-4, -2, 4, 2, -4), far(-30, -9, 5, 20, -60), behind(3, 0, 6, 1, 40);
  for (const std::vector<DrawObject>& objects : {std::vector<DrawObject>{near.object()},
                                                 {near.object(), far.object()},
                                                 {behind.object()},
                                                 {near.object(), far.object(), behind.object()},
                                                 {}}) {
    const View main = front_view();
    const Camera camera = birdseye_camera(objects, main);
    const View view(camera);
    // Against the main up direction, with the main line of sight up the picture.
    EXPECT_LT(glm::length(view.direction() - glm::dvec3(0, -1, 0)), 1e-9);
    EXPECT_LT(glm::length(camera.up - glm::dvec3(0, 0, -1)), 1e-9);
    EXPECT_EQ(camera.width, 100);
    EXPECT_EQ(camera.height, 80);
    std::vector<glm::dvec3> points = {main.camera().eye};
    for (const DrawObject& object : objects)
      points.insert(points.end(), object.positions.begin(), object.positions.end());
    for (const glm::dvec3& p : points) {
      const glm::dvec2 q = on_image(view, p);
      EXPECT_TRUE(q.x >= 0 && q.x <= 100 && q.y >= 0 && q.y <= 80) << q.x << "," << q.y;
    }
  }
}

TEST(Birdseye, TellsSeenFromUnseen) {
  // Roofs that slope towards the viewer: the second is hidden by the first, the third is out of view.
  Quad front(-3, -2, 3, 2, -4), hidden(-2, -2, 2, 2, -10), outside(20, -2, 26, 2, -4);
  for (Quad* quad : {&front, &hidden, &outside}) quad->positions[2].z -= 3, quad->positions[3].z -= 3;
  hidden.positions[2].y = hidden.positions[3].y = 1;
  const std::array<DrawObject, 3> objects = {front.object(), hidden.object(), outside.object()};
  ItemBuffer items;
  draw_items(items, objects, front_view());
  ASSERT_EQ(count_visible_items(items, 6), 2U);
  // Large enough that lines are thin beside the quads.
  Camera camera = birdseye_camera(objects, front_view());
  camera.width *= 10;
  camera.height *= 10;
  const View above(camera);
  const Image image = birdseye(objects, items, front_view(), above);
  const auto color_at = [&](const glm::dvec3& p) {
    const glm::dvec2 q = on_image(above, p);
    return pixel(image, static_cast<int>(q.x), static_cast<int>(q.y));
  };
  const glm::u8vec4 seen = color_at({1.0, 0, -5.5});
  EXPECT_GT(seen.x, seen.z + 60);
  for (const glm::dvec3& p : {glm::dvec3(0.5, -1, -11), glm::dvec3(23.5, 0, -5.5)}) {
    const glm::u8vec4 unseen = color_at(p);
    EXPECT_GT(unseen.z, unseen.x + 20);
    EXPECT_LT(test::brightness(unseen), test::brightness(seen));
  }
}

// A red and a blue square, seen from the front; their boxes reach half a unit farther than they do.
TEST(Birdseye, MarksObjectsAndTheirBoxes) {
  const Quad red(-3, -1, -1, 1, -5), blue(1, -1, 3, 1, -5);
  const std::array<DrawObject, 2> objects = {red.object(), blue.object()};
  const std::array<MarkedObject, 2> marks = {MarkedObject{{{-3.5F, -1.5F, -5}, {-0.5F, 1.5F, -5}}, {1.0F, 0.0F, 0.0F}},
                                             MarkedObject{{{0.5F, -1.5F, -5}, {3.5F, 1.5F, -5}}, {0.0F, 0.0F, 1.0F}}};
  Camera camera = front_view().camera();
  camera.width *= 10;
  camera.height *= 10;
  const View view(camera);
  const Image image = birdseye_boxes(objects, marks, front_view(), view);
  const auto color_at = [&](const glm::dvec3& p) {
    const glm::dvec2 q = on_image(view, p);
    return pixel(image, static_cast<int>(q.x), static_cast<int>(q.y));
  };
  for (const double x : {-2.3, -3.5}) {  // inside, and on the edge of the box
    const glm::u8vec4 color = color_at({x, 0.4, -5});
    EXPECT_GT(color.x, color.z + 60) << x;
  }
  for (const double x : {2.3, 3.5}) {
    const glm::u8vec4 color = color_at({x, 0.4, -5});
    EXPECT_GT(color.z, color.x + 60) << x;
  }
  EXPECT_LT(test::brightness(color_at({-3.25, 0.4, -5})), test::brightness(color_at({-3.5, 0.4, -5})));  // between them
}

TEST(Birdseye, DrawsTheFrustumInYellow) {
  const Quad quad(-1, -1, 1, 1, -20);
  const std::array<DrawObject, 1> objects = {quad.object()};
  ItemBuffer items;
  draw_items(items, objects, front_view());
  const View above(birdseye_camera(objects, front_view()));
  const Image image = birdseye(objects, items, front_view(), above);
  // The right lower edge leaves the eye along (50 / 40, -1, -1): at depth 8 it passes (10, -8, -8).
  const glm::dvec2 on_line = on_image(above, {10, -8, -8});
  const glm::u8vec4 line = pixel(image, static_cast<int>(on_line.x), static_cast<int>(on_line.y));
  EXPECT_GT(line.x, line.z + 100);
  EXPECT_GT(line.y, line.z + 80);
  const glm::dvec2 inside = on_image(above, {0, 0, -8});
  const glm::u8vec4 ground = pixel(image, static_cast<int>(inside.x), static_cast<int>(inside.y));
  EXPECT_LT(ground.x, ground.z + 20);
}

}  // namespace
}  // namespace occlod
