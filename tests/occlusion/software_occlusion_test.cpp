// The backend `software`: what is in front is never hidden, what is behind a wall is.
#include "raster/software_occlusion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <vector>

#include "occlod/item_buffer.h"
#include "occlod/visibility.h"
#include "oracle/judge.h"
#include "support/cameras.h"

namespace occlod {
namespace {

using test::BoundKind;
using test::RandomShapes;

// The eye at the origin looks along -z; f = 50 px, image 100 x 100. The wall is a square at z = -5 from -half to half.
class WallScene {
 public:
  explicit WallScene(float half, bool count_pixels = false)
      : positions_{{-half, -half, -5}, {half, -half, -5}, {half, half, -5}, {-half, half, -5}},
        backend_(make_software_occlusion(count_pixels)) {
    const std::vector<ObjectView> objects(1, ObjectView(view(), glm::dmat4(1.0)));
    backend_->begin_view(view(), objects);
    const std::vector<OccluderPart> parts = {{0, positions_, triangles_}};
    backend_->draw_occluder(parts);
  }

  static View view() {
    Camera camera = test::origin_camera(100, 100);
    camera.near = 0.5;
    camera.far = 10'000.0;
    return View(camera);
  }

  std::uint32_t ask(const VisibilityQuery& query) {
    backend_->submit(query);
    return backend_->collect();
  }
  Visibility& backend() { return *backend_; }

 private:
  std::vector<glm::vec3> positions_;
  std::vector<Triangle> triangles_ = {{0, 1, 2}, {0, 2, 3}};
  std::unique_ptr<Visibility> backend_;
};

TEST(SoftwareOcclusion, ASmallSphereAndAWall) {
  WallScene scene(2.0F);                                             // pixels 30 to 69
  EXPECT_EQ(scene.ask({0, Sphere{{0, 0, -8}, 1.0F}}), 0U);           // behind
  EXPECT_EQ(scene.ask({0, Sphere{{0, 0, -3}, 0.5F}}), 1U);           // in front
  EXPECT_EQ(scene.ask({0, Sphere{{0, 0, -5}, 0.5F}}), 1U);           // through it
  EXPECT_EQ(scene.ask({0, Sphere{{0, 0, -5.4F}, 0.5F}}), 1U);        // its front pokes out by 0.1
  EXPECT_EQ(scene.ask({0, Sphere{{0, 0, -5.6F}, 0.5F}}), 0U);        // 0.1 behind
  EXPECT_EQ(scene.ask({0, Sphere{{3.2F, 0, -8}, 0.5F}}), 1U);        // straddles the wall's border at x / z = 0.4
  EXPECT_EQ(scene.ask({0, Sphere{{0, -3.2F, -8}, 0.5F}}), 1U);       // and below
  EXPECT_EQ(scene.ask({0, Sphere{{2.2F, 0, -8}, 0.5F}}), 0U);        // within it
  EXPECT_EQ(scene.ask({0, Sphere{{5, 0, -8}, 0.5F}}), 1U);           // beside it
  EXPECT_EQ(scene.ask({0, Sphere{{30, 0, -8}, 0.5F}}), 0U);          // beside the image
  EXPECT_EQ(scene.ask({0, Sphere{{0, 0, -8}, 1e-6F}}), 0U);          // less than a pixel, behind
  EXPECT_EQ(scene.ask({0, Sphere{{0.33F, 0.21F, -3}, 1e-6F}}), 1U);  // in front
  EXPECT_EQ(scene.ask({0, Sphere{{0, 0, 0}, 0.1F}}), 1U);            // the eye inside
  EXPECT_EQ(scene.ask({0, Sphere{{0, 0, -2}, 1.7F}}), 1U);           // crosses the near plane
  EXPECT_EQ(scene.ask({0, Sphere{{0, 0, 5}, 1.0F}}), 1U);            // behind the eye: not ours to decide
}

// The occluder must be strictly nearer: what touches it is visible, whatever its shape.
TEST(SoftwareOcclusion, WhatTouchesTheOccluderIsVisible) {
  WallScene scene(2.0F);
  const std::vector<glm::vec3> on_the_wall = {{0.1F, 0.1F, -5}, {0.3F, 0.1F, -5}, {0.2F, 0.2F, -6}};
  EXPECT_EQ(scene.ask({0, Box{{-0.5F, -0.5F, -6}, {0.5F, 0.5F, -5}}}), 1U);
  EXPECT_EQ(scene.ask({0, Box{{-0.5F, -0.5F, -6}, {0.5F, 0.5F, -5.001F}}}), 0U);
  EXPECT_EQ(scene.ask({0, Sphere{{0, 0, -5.5F}, 0.5F}}), 1U);
  EXPECT_EQ(scene.ask({0, Cylinder{{0, 0, -5.5F}, 0.5F, {0, 1, 0}, -0.5F, 0.5F}}), 1U);
  EXPECT_EQ(scene.ask({0, Cylinder{{0, 0, -5.5F}, 0.2F, {0, 0, 1}, -0.5F, 0.5F}}), 1U);
  EXPECT_EQ(scene.ask({0, PointHull{on_the_wall}}), 1U);
}

TEST(SoftwareOcclusion, WhatIsLargerThanTheScreen) {
  WallScene everything(6.0F);
  EXPECT_EQ(everything.ask({0, Sphere{{0, 0, -1000}, 990.0F}}), 0U);  // all of it behind the wall
  EXPECT_EQ(everything.ask({0, Sphere{{0, 0, -1000}, 996.0F}}), 1U);  // nearest at 4
  EXPECT_EQ(everything.ask({0, Box{{-99, -99, -99}, {99, 99, -6}}}), 0U);
  EXPECT_EQ(everything.ask({0, Box{{-99, -99, -99}, {99, 99, -4}}}), 1U);
  EXPECT_EQ(everything.ask({0, Cylinder{{0, 0, -50}, 44.0F, {0, 1, 0}, -100, 100}}), 0U);
  EXPECT_EQ(everything.ask({0, Cylinder{{0, 0, -50}, 46.0F, {0, 1, 0}, -100, 100}}), 1U);
  WallScene most(4.9F);  // pixels 1 to 98: a border of a pixel is open
  EXPECT_EQ(most.ask({0, Sphere{{0, 0, -1000}, 990.0F}}), 1U);
}

TEST(SoftwareOcclusion, CountsThePixelsOfTheRectangle) {
  WallScene scene(2.0F, true);  // pixels 30 to 69, both ways
  // Faces at z = -8 and -10: 50 * x / 8 px. From x = -2.32 to 2.32: 35.5 to 64.5, so pixels 35 to 64: all behind the
  // wall.
  EXPECT_EQ(scene.ask({0, Box{{-2.32F, -2.32F, -10}, {2.32F, 2.32F, -8}}}), 0U);
  // To x = 4: 75 +- slack, so pixels 35 to 75; those from 70 on are beside the wall: 6 columns of 30 rows.
  EXPECT_EQ(scene.ask({0, Box{{-2.32F, -2.32F, -10}, {4.0F, 2.32F, -8}}}), 6U * 30U);
  // Before the wall: 50 * 0.45 / 3 = 7.5, pixels 42 to 57.
  EXPECT_EQ(scene.ask({0, Box{{-0.45F, -0.45F, -4}, {0.45F, 0.45F, -3}}}), 16U * 16U);
  EXPECT_EQ(scene.ask({0, Sphere{{0, 0, 0}, 0.1F}}), 100U * 100U);
}

TEST(SoftwareOcclusion, AnswersInOrder) {
  WallScene scene(2.0F);
  const VisibilityQuery hidden{0, Sphere{{0, 0, -8}, 1.0F}}, visible{0, Sphere{{0, 0, -3}, 0.5F}};
  for (const bool first : {true, false, false, true, true, false}) scene.backend().submit(first ? visible : hidden);
  EXPECT_EQ(scene.backend().collect(), 1U);
  EXPECT_EQ(scene.backend().collect(), 0U);
  scene.backend().submit(visible);  // between collects
  for (const std::uint32_t expected : {0U, 1U, 1U, 0U, 1U}) EXPECT_EQ(scene.backend().collect(), expected);
  EXPECT_EQ(scene.backend().flight(), 1U);
  EXPECT_TRUE(scene.backend().can_hide());
}

TEST(SoftwareOcclusion, ANewViewForgetsTheOccluderAndItsQuestions) {
  WallScene scene(2.0F);
  const VisibilityQuery hidden{0, Sphere{{0, 0, -8}, 1.0F}};
  EXPECT_EQ(scene.ask(hidden), 0U);
  scene.backend().submit(hidden);  // never collected
  const std::vector<ObjectView> objects(1, ObjectView(WallScene::view(), glm::dmat4(1.0)));
  scene.backend().begin_view(WallScene::view(), objects);
  EXPECT_EQ(scene.ask(hidden), 1U);
  scene.backend().draw_occluder({});
  EXPECT_EQ(scene.ask(hidden), 1U);
}

// Only what has changed is emptied and reduced again: a backend that has seen other occluders answers as a new one
// does.
TEST(SoftwareOcclusion, AnOccluderLeavesNothingBehind) {
  RandomShapes random(8);
  const View view = WallScene::view();
  const std::vector<ObjectView> objects(1, ObjectView(view, glm::dmat4(1.0)));
  const auto used = make_software_occlusion(true);
  used->begin_view(view, objects);
  std::size_t hidden = 0;
  for (int n = 0; n < 60; ++n) {
    // A triangle somewhere, some of them through the near plane, some beside the image, and now and then none at all.
    std::vector<glm::vec3> positions;
    for (int k = 0; k < 3; ++k) positions.emplace_back(random.point(n % 3 == 0 ? 12.0 : 3.0) - glm::dvec3(0, 0, 3));
    const std::vector<Triangle> triangles = n % 7 == 6 ? std::vector<Triangle>{} : std::vector<Triangle>{{0, 1, 2}};
    const std::vector<OccluderPart> parts = {{0, positions, triangles}};
    const auto fresh = make_software_occlusion(true);
    fresh->begin_view(view, objects);
    for (Visibility* backend : {used.get(), fresh.get()}) backend->draw_occluder(parts);
    for (int i = 0; i < 100; ++i) {
      VisibilityQuery query = random.bound(static_cast<BoundKind>(i % 3), 0.5);
      if (i % 3 == 0) query.shape = Sphere{glm::vec3(random.point(6.0) - glm::dvec3(0, 0, 8)), 0.1F};
      for (Visibility* backend : {used.get(), fresh.get()}) backend->submit(query);
      const std::uint32_t answer = used->collect();
      ASSERT_EQ(answer, fresh->collect()) << n << " " << i;
      hidden += answer == 0 ? 1 : 0;
    }
  }
  EXPECT_GT(hidden, 100U);
}

// One picture is drawn over another where nearness allows it: a hundred in a row answer as if each were the first. From
// far away and from near, so that old pictures are nearer than new ones; a range of depths that leaves room for a few
// pictures, and one for many.
TEST(SoftwareOcclusion, PicturesInARowAnswerAsEachByItself) {
  for (const double far : {40.0, 4e9}) {
    RandomShapes random(12);
    const auto in_a_row = make_software_occlusion();
    std::size_t hidden = 0, visible = 0;
    for (int n = 0; n < 100; ++n) {
      Camera camera;
      camera.eye = random.in(1.0, 12.0) * random.unit();
      camera.width = 90;
      camera.height = 70;
      camera.near = 0.1;
      camera.far = far;
      const View view(camera);
      const std::vector<ObjectView> objects(1, ObjectView(view, glm::dmat4(1.0)));
      std::vector<glm::vec3> positions;
      std::vector<Triangle> triangles;
      for (std::uint32_t i = 0; i < 6; ++i) {
        for (int k = 0; k < 3; ++k) positions.emplace_back(random.point(2.0));
        triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
      }
      const std::vector<OccluderPart> parts = {{0, positions, triangles}};
      std::vector<VisibilityQuery> queries;
      std::vector<glm::vec3> points;
      for (int i = 0; i < 100; ++i) {
        queries.push_back(random.bound(random.kind(), i % 10 == 0 ? 8.0 : 0.3));
        points.emplace_back(random.point(3.0));
      }
      const auto alone = make_software_occlusion();
      std::vector<std::uint32_t> answers(queries.size()), expected(queries.size());
      std::vector<std::uint8_t> shows(points.size()), expected_shows(points.size());
      for (Visibility* backend : {in_a_row.get(), alone.get()}) {
        const bool is_alone = backend == alone.get();
        backend->begin_view(view, objects);
        backend->draw_occluder(parts);
        backend->answer(queries, is_alone ? expected : answers);
        backend->find_visible_points(0, points, is_alone ? expected_shows : shows);
      }
      ASSERT_EQ(answers, expected) << n;
      ASSERT_EQ(shows, expected_shows) << n;
      for (const std::uint32_t answer : answers) ++(answer == 0 ? hidden : visible);
    }
    EXPECT_GT(hidden, 500U);
    EXPECT_GT(visible, 500U);
  }
}

TEST(SoftwareOcclusion, DrawsEachObjectWhereItIs) {
  // The wall of the object's own space, moved behind the sphere and then before it.
  const std::vector<glm::vec3> wall = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 3}};
  const View view = WallScene::view();
  const auto backend = make_software_occlusion();
  for (const double z : {-20.0, -5.0}) {
    const std::vector<ObjectView> objects = {ObjectView(view, glm::dmat4(1.0)),
                                             ObjectView(view, glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, z)))};
    backend->begin_view(view, objects);
    const std::vector<OccluderPart> parts = {{1, wall, triangles}};
    backend->draw_occluder(parts);
    backend->submit({0, Sphere{{0, 0, -8}, 0.5F}});
    EXPECT_EQ(backend->collect(), z == -20.0 ? 1U : 0U);
  }
}

class SoftwareVerdicts : public testing::TestWithParam<test::SceneKind> {};
INSTANTIATE_TEST_SUITE_P(Scenes, SoftwareVerdicts, testing::ValuesIn(test::scene_kinds),
                         [](const auto& param) { return test::label(param.param); });

// What a ray sees in front of the occluder is never hidden; of what no ray sees most is found. tests/gl asks all
// backends the same, where OpenGL is built.
TEST_P(SoftwareVerdicts, AreThoseOfRays) {
  std::vector<std::unique_ptr<Visibility>> backends;
  backends.push_back(make_software_occlusion());
  const test::Tally tally = test::tally(test::judge(GetParam(), backends, 40, 150), 0);
  if (!tally.wrong.empty()) ADD_FAILURE() << "hides " << tally.wrong.size() << " bounds, first " << tally.wrong.front();
  EXPECT_GT(tally.must_show, 1000);
  EXPECT_GT(tally.hidden, 150);
  EXPECT_GE(tally.found, 0.8 * tally.hidden);
}

}  // namespace
}  // namespace occlod
