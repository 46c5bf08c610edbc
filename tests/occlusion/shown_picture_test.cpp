// The backend `software` with a picture: what it hides, seen from where it was taken.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/ext/matrix_transform.hpp>
#include <memory>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "occlod/item_buffer.h"
#include "occlod/visibility.h"
#include "oracle/random_view.h"
#include "support/cameras.h"

namespace occlod {
namespace {

using test::BoundKind;
using test::RandomShapes;

// Triangles at random and bounds among them.
struct RandomScene {
  explicit RandomScene(RandomShapes& random) {
    for (std::uint32_t i = 0; i < 6; ++i) {
      for (int k = 0; k < 3; ++k) positions.emplace_back(random.point(2.0));
      triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    for (int i = 0; i < 100; ++i) {
      queries.push_back(random.bound(random.kind(), i % 10 == 0 ? 8.0 : 0.3));
      points.emplace_back(random.point(3.0));
    }
  }

  [[nodiscard]] DepthBuffer drawn(const View& view) const {
    DepthBuffer depth;
    depth.reset(view.width(), view.height());
    draw_depth(depth, positions, triangles, ObjectView(view, glm::dmat4(1.0)).object_to_clip());
    return depth;
  }
  [[nodiscard]] std::vector<std::uint32_t> answers(Visibility& backend) const {
    std::vector<std::uint32_t> found(queries.size());
    backend.answer(queries, found);
    return found;
  }
  [[nodiscard]] std::vector<std::uint8_t> shown_points(Visibility& backend) const {
    std::vector<std::uint8_t> shown(points.size());
    backend.find_visible_points(0, points, shown);
    return shown;
  }

  std::vector<glm::vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<VisibilityQuery> queries;
  std::vector<glm::vec3> points;
};

std::vector<ObjectView> one_object(const View& view) { return {ObjectView(view, glm::dmat4(1.0))}; }

// Pictures of odd sizes are kept whole.
Camera camera_at(const glm::dvec3& eye, int width = 91, int height = 71) {
  Camera camera;
  camera.eye = eye;
  camera.width = width;
  camera.height = height;
  camera.near = 0.1;
  camera.far = 40.0;
  return camera;
}

std::unique_ptr<Visibility> with_occluder(const RandomScene& scene, const View& view) {
  std::unique_ptr<Visibility> software = make_software_occlusion();
  software->begin_view(view, one_object(view));
  const std::vector<OccluderPart> parts = {{0, scene.positions, scene.triangles}};
  software->draw_occluder(parts);
  return software;
}

TEST(ShownPicture, AnswersFromThePlaceOfThePictureAsSoftwareDoes) {
  RandomShapes random(21);
  const auto picture = make_software_occlusion();
  std::size_t hidden = 0, visible = 0;
  for (int n = 0; n < 60; ++n) {
    const RandomScene scene(random);
    const View view(camera_at(random.in(1.0, 12.0) * random.unit()));
    picture->show(scene.drawn(view), view, one_object(view));
    picture->begin_view(view, one_object(view));
    EXPECT_TRUE(picture->has_picture());
    const auto software = with_occluder(scene, view);
    const std::vector<std::uint32_t> answers = scene.answers(*picture);
    ASSERT_EQ(answers, scene.answers(*software)) << n;
    ASSERT_EQ(scene.shown_points(*picture), scene.shown_points(*software)) << n;
    for (const std::uint32_t answer : answers) ++(answer == 0 ? hidden : visible);
  }
  EXPECT_GT(hidden, 300U);
  EXPECT_GT(visible, 300U);
}

// What a picture hides of what an occluder hides, of all bounds so far.
struct Hidden {
  std::size_t by_picture = 0, by_occluder = 0;

  // Whatever the picture hides the occluder hides.
  void add(const std::vector<std::uint32_t>& picture, const std::vector<std::uint32_t>& occluder) {
    for (std::size_t i = 0; i < picture.size(); ++i) {
      ASSERT_TRUE(picture[i] != 0 || occluder[i] == 0) << i;
      by_picture += picture[i] == 0 ? 1U : 0U;
      by_occluder += occluder[i] == 0 ? 1U : 0U;
    }
  }
};

// From elsewhere, whatever it hides is hidden from where the picture was taken, and lies within the picture.
TEST(ShownPicture, HidesFromElsewhereOnlyWhatThePictureHides) {
  RandomShapes random(22);
  const auto picture = make_software_occlusion();
  Hidden hidden;
  for (int n = 0; n < 100; ++n) {
    const RandomScene scene(random);
    const Camera from = camera_at(random.in(1.0, 12.0) * random.unit());
    Camera to = from;
    to.eye += 0.1 * random.unit();
    to.target += 0.3 * random.unit();
    const View taken(from), now(to);
    picture->show(scene.drawn(taken), taken, one_object(taken));
    picture->begin_view(now, one_object(now));
    const auto software = with_occluder(scene, taken);
    SCOPED_TRACE(n);
    ASSERT_NO_FATAL_FAILURE(hidden.add(scene.answers(*picture), scene.answers(*software)));
  }
  EXPECT_GT(hidden.by_picture, 300U);
  EXPECT_GT(hidden.by_occluder - hidden.by_picture, 100U);
}

// The eye at the origin looks along -z at a wall that fills the picture. Then it turns to the left.
TEST(ShownPicture, WhatComesIntoViewAtASideIsVisible) {
  Camera camera = test::origin_camera(100, 100);
  camera.near = 0.5;
  camera.far = 100.0;
  const View taken(camera);
  DepthBuffer wall;
  wall.reset(100, 100);
  std::fill(wall.nearness.begin(), wall.nearness.end(), 1.0F / 5.0F);
  const auto picture = make_software_occlusion();
  picture->show(wall, taken, one_object(taken));
  const auto ask = [&](const glm::vec3& center) {
    picture->submit({0, Sphere{center, 0.1F}});
    return picture->collect();
  };
  picture->begin_view(taken, one_object(taken));
  EXPECT_EQ(ask({0, 0, -8}), 0U);
  EXPECT_EQ(ask({-8, 0, -8}), 0U);  // at the left border, beyond which this view shows nothing
  camera.target = {-0.2, 0, -1};
  const View now(camera);
  picture->begin_view(now, one_object(now));
  EXPECT_EQ(ask({0, 0, -8}), 0U);
  EXPECT_EQ(ask({-8, 0, -8}), 1U);     // at the border
  EXPECT_EQ(ask({-8.5F, 0, -8}), 1U);  // beyond it
  EXPECT_EQ(ask({7.9F, 0, -8}), 0U);   // at the other border
}

TEST(ShownPicture, ADrawnOccluderReplacesThePicture) {
  RandomShapes random(23);
  const auto picture = make_software_occlusion();
  for (int n = 0; n < 20; ++n) {
    const RandomScene scene(random), other(random);
    const View taken(camera_at(random.in(1.0, 12.0) * random.unit())),
        now(camera_at(random.in(1.0, 12.0) * random.unit()));
    picture->show(other.drawn(taken), taken, one_object(taken));
    picture->begin_view(now, one_object(now));
    const std::vector<OccluderPart> parts = {{0, scene.positions, scene.triangles}};
    picture->draw_occluder(parts);
    EXPECT_FALSE(picture->has_picture());
    ASSERT_EQ(scene.answers(*picture), scene.answers(*with_occluder(scene, now))) << n;
    picture->begin_view(now, one_object(now));  // without a picture nothing is hidden
    const std::vector<std::uint32_t> answers = scene.answers(*picture);
    const auto nothing = make_software_occlusion();
    nothing->begin_view(now, one_object(now));
    ASSERT_EQ(answers, scene.answers(*nothing)) << n;
  }
}

// Of pictures with even sides half the size is kept. It hides nothing that the whole picture does not, and what is some
// pixels smaller than what hides it. All widths up to some vectors, so that each column counts.
TEST(ShownPicture, OfEvenSizeHidesALittleLess) {
  RandomShapes random(24);
  const auto halved = make_software_occlusion();
  Hidden hidden;
  for (int n = 0; n < 120; ++n) {
    const RandomScene scene(random);
    const View view(camera_at(random.in(1.0, 12.0) * random.unit(), 60 + 2 * n, 70));
    halved->show(scene.drawn(view), view, one_object(view));
    halved->begin_view(view, one_object(view));
    const auto whole = with_occluder(scene, view);
    SCOPED_TRACE(n);
    ASSERT_NO_FATAL_FAILURE(hidden.add(scene.answers(*halved), scene.answers(*whole)));
  }
  EXPECT_LT(hidden.by_picture, hidden.by_occluder);
  EXPECT_GT(10 * hidden.by_picture, 9 * hidden.by_occluder);
}

TEST(ShownPicture, RefusesPicturesOfOtherSizesAndBeforeAnyView) {
  const auto message_of = [](const auto& call) {
    try {
      call();
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto picture = make_software_occlusion();
  DepthBuffer depth;
  depth.reset(91, 71);
  EXPECT_NE(message_of([&] { picture->show(depth); }).find("before the first view"), std::string::npos);
  const View view(camera_at({0, 0, 3}));
  picture->begin_view(view, one_object(view));
  EXPECT_EQ(message_of([&] { picture->show(depth); }), "");
  depth.reset(71, 91);
  EXPECT_NE(message_of([&] { picture->show(depth); }).find("71 x 91 pixels"), std::string::npos);
}

// Depth of a graphics interface, as its matrices make it, is that of our own picture, or a little farther.
TEST(ReadDepth, OfEveryConvention) {
  RandomShapes random(25);
  for (int n = 0; n < 40; ++n) {
    const RandomScene scene(random);
    Camera camera = camera_at(random.in(2.0, 12.0) * random.unit());
    const bool is_orthographic = n % 4 == 3;
    if (is_orthographic) camera.orthographic_height = 5.0;
    const View view(camera);
    const DepthBuffer drawn = scene.drawn(view);
    for (const ClipDepth clip : {ClipDepth::minus_one_to_one, ClipDepth::zero_to_one, ClipDepth::one_to_zero})
      for (const bool from_bottom : {false, true}) {
        std::vector<float> depth(drawn.nearness.size());
        for (int y = 0; y < drawn.height; ++y)
          for (int x = 0; x < drawn.width; ++x) {
            const double nearness = drawn.nearness[static_cast<std::size_t>(y * drawn.width + x)];
            const double w = is_orthographic ? 1.0 : 1.0 / nearness;
            const double distance = nearness > 0.0 ? view.distance_at(nearness) : camera.far;
            // z and w of a point of this distance by the matrix of OpenGL.
            const double range = camera.far - camera.near;
            const double z = is_orthographic
                                 ? (2.0 * distance - camera.far - camera.near) / range
                                 : ((camera.far + camera.near) * distance - 2.0 * camera.far * camera.near) / range;
            const double in_window = nearness > 0.0 ? (z / w + 1.0) / 2.0 : 1.0;
            const int row = from_bottom ? drawn.height - 1 - y : y;
            depth[static_cast<std::size_t>(row * drawn.width + x)] =
                static_cast<float>(clip == ClipDepth::one_to_zero ? 1.0 - in_window : in_window);
          }
        DepthBuffer read;
        read_depth(read, depth, view, clip, from_bottom);
        ASSERT_EQ(read.nearness.size(), drawn.nearness.size());
        for (std::size_t i = 0; i < drawn.nearness.size(); ++i) {
          const float least = drawn.nearness[i] > 0.0F || is_orthographic ? drawn.nearness[i] : 1.0F / 40.0F;
          ASSERT_LE(read.nearness[i], least * (1.0F + 1e-6F)) << n << " " << i;
          ASSERT_GE(read.nearness[i], least - 4e-6F) << n << " " << i;
        }
      }
  }
}

}  // namespace
}  // namespace occlod
