// Sessions whose camera is orthographic.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "occlod/base.h"
#include "session.h"
#include "viewer/support.h"

namespace occlod::viewer {
namespace {

using nlohmann::json;
using test::act;

// In front of the planet, all of which is in the picture.
class Orthographic : public ::testing::Test {
 protected:
  void SetUp() override {
    act(session_, {{"do", "open"}, {"file", folder_.write("planet.json", test::planet_scene(6)).string()}});
    act(session_, {{"do", "set"}, {"setting", "frame_to_frame"}, {"value", false}});
    act(session_, {{"do", "go_to"}, {"name", "far"}});
  }
  void perform(const json& action) { act(session_, action); }
  [[nodiscard]] const Camera& camera() const { return session_.state().camera; }
  [[nodiscard]] double height() const { return camera().orthographic_height.value_or(0.0); }
  [[nodiscard]] glm::dvec2 place_of(const glm::dvec3& point) const {
    const glm::dvec4 clip = View(camera()).world_to_clip() * glm::dvec4(point, 1.0);
    return {0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w};
  }

  test::Folder folder_;
  Session session_{test::make_portable_visibility, false};
};

TEST_F(Orthographic, IsSwitchedOnAndOff) {
  const Camera before = camera();
  perform({{"do", "orthographic"}});
  EXPECT_DOUBLE_EQ(height(), *orthographic(before).orthographic_height);
  perform({{"do", "orthographic"}, {"on", true}});
  EXPECT_GT(height(), 0.0);  // still
  perform({{"do", "orthographic"}});
  EXPECT_EQ(height(), 0.0);
  EXPECT_LT(glm::distance(camera().eye, before.eye), 1e-12);
  EXPECT_EQ(camera().fov_y_deg, before.fov_y_deg);
}

// A camera has an angle or a height, and the one that is given last.
TEST_F(Orthographic, CameraTakesAnAngleOrAHeight) {
  perform({{"do", "camera"}, {"orthographic_height", 1.5}});
  EXPECT_EQ(height(), 1.5);
  perform({{"do", "camera"}, {"eye", {0, 0, 4}}});
  EXPECT_EQ(height(), 1.5);
  for (const double wrong : {0.0, -1.0})
    EXPECT_THROW(perform({{"do", "camera"}, {"orthographic_height", wrong}}), Error);
  EXPECT_THROW(perform({{"do", "camera"}, {"orthographic_height", 2}, {"fov_y_deg", 30}}), Error);
  EXPECT_EQ(height(), 1.5);
  perform({{"do", "camera"}, {"fov_y_deg", 30}});
  EXPECT_EQ(height(), 0.0);
  EXPECT_EQ(camera().fov_y_deg, 30.0);
  for (const bool parallel : {false, true}) {  // no image at all
    perform({{"do", "orthographic"}, {"on", parallel}});
    for (int i = 0; i < 300; ++i) {
      const Camera before = camera();
      try {
        perform({{"do", "zoom"}, {"factor", 1e-5}});
      } catch (const Error&) {
        EXPECT_EQ(camera(), before);
        break;
      }
      ASSERT_LT(i, 290);
    }
    perform({{"do", "frame_all"}});
  }
}

// With everything else of the camera as it was.
TEST_F(Orthographic, HeightAloneIsAnotherMesh) {
  perform({{"do", "orthographic"}});
  const std::uint64_t before = session_.frame()->hash;
  Camera narrow = camera();
  narrow.orthographic_height = 1.0;
  perform({{"do", "camera"}, {"orthographic_height", 1.0}, {"near", narrow.near}, {"far", narrow.far}});
  EXPECT_EQ(camera(), narrow);
  EXPECT_NE(session_.frame()->hash, before);
  EXPECT_EQ(session_.frame()->job.camera, camera());
}

// What is clicked on is where the picture shows it, also far from the middle, where perspective's rays lead elsewhere.
TEST_F(Orthographic, PicksWhatIsUnderTheCursor) {
  perform({{"do", "orthographic"}});
  const glm::dvec2 cursor(0.5, 0.22);
  perform({{"do", "pick"}, {"x", cursor.x}, {"y", cursor.y}});
  ASSERT_TRUE(session_.state().pick);
  const glm::dvec3 point = session_.state().pick->point;
  EXPECT_LT(glm::distance(place_of(point), cursor), 1e-6);
  EXPECT_GT(point.z, 0.0);  // the near side
  EXPECT_NEAR(glm::length(point), 1.0, 0.1);
  perform({{"do", "look_at"}, {"x", cursor.x}, {"y", cursor.y}});
  EXPECT_LT(glm::distance(camera().target, point), 1e-6);
  EXPECT_LT(glm::distance(place_of(point), glm::dvec2(0.5)), 1e-9);
}

TEST_F(Orthographic, DraggedObjectFollowsTheCursor) {
  perform({{"do", "orthographic"}});
  perform({{"do", "select"}, {"object", session_.state().objects->at(0).id}});
  const auto place = [&] { return place_of(glm::dvec3(session_.state().objects->at(0).object_to_world[3])); };
  const glm::dvec2 before = place();
  perform({{"do", "drag"}, {"right", 0.1}, {"up", 0.05}});
  EXPECT_LT(glm::distance(place(), before + glm::dvec2(0.1, -0.05)), 1e-9);
}

// Ahead shows less, aside shifts, and from no ground is walked: half a second each at half a radius of the scene a
// second. All of the planet stays before the eye.
TEST_F(Orthographic, FlyingAndWalkingZoom) {
  perform({{"do", "orthographic"}});
  const double radius = bounds_of(*session_.state().objects).radius;
  for (const char* steering : {"fly", "walk"}) {
    perform({{"do", "set"}, {"setting", "steering"}, {"value", steering}});
    const Camera before = camera();
    const glm::dvec3 ahead = glm::normalize(before.target - before.eye);
    perform({{"do", "move"}, {"ahead", 1}, {"right", 1}, {"seconds", 0.5}});
    EXPECT_NEAR(height(), *before.orthographic_height * std::exp(-0.25), 1e-9);
    EXPECT_NEAR(glm::distance(camera().target, before.target), 0.25 * radius, 1e-9);
    EXPECT_NEAR(glm::dot(camera().target - before.target, ahead), 0.0, 1e-9);
    EXPECT_GT(glm::dot(-camera().eye, ahead), radius);
  }
}

TEST_F(Orthographic, BookmarksAndScenesKeepIt) {
  perform({{"do", "camera"}, {"orthographic_height", 1.25}});
  perform({{"do", "bookmark"}, {"name", "flat"}});
  perform({{"do", "go_to"}, {"name", "far"}});
  EXPECT_EQ(height(), 0.0);
  perform({{"do", "go_to"}, {"name", "flat"}});
  EXPECT_EQ(height(), 1.25);
  const auto file = folder_.path("saved.json").string();
  perform({{"do", "save_scene"}, {"file", file}});
  const std::uint64_t hash = session_.frame()->hash;
  perform({{"do", "close_all"}});
  perform({{"do", "open"}, {"file", file}});
  EXPECT_EQ(height(), 1.25);
  EXPECT_EQ(session_.state().bookmarks.at("flat").orthographic_height, 1.25);
  session_.set_view_size({camera().width, camera().height});
  EXPECT_EQ(session_.frame()->hash, hash);
}

// Scene files refuse a path that goes from one kind of camera to the other. All keys are as the first one, from where
// what is looked at is as large as it was shown.
TEST_F(Orthographic, RecordedPathIsOfOneKind) {
  for (const bool parallel : {false, true}) {
    perform({{"do", "orthographic"}, {"on", parallel}});
    session_.perform(json{{"do", "record"}, {"name", "mine"}});
    const std::size_t notices = session_.state().notices.size();
    for (int i = 0; i < 6; ++i) {
      if (i == 3) session_.perform(json{{"do", "orthographic"}, {"on", !parallel}});
      session_.update(1.0 / 30.0 + 1e-9, 1000.0);
    }
    EXPECT_EQ(session_.state().notices.size(), notices + 1);
    EXPECT_FALSE(session_.state().notices.back().is_error);
    perform({{"do", "stop"}});
    const CameraPath& path = session_.state().paths.at("mine");
    ASSERT_EQ(path.keys.size(), 7U);
    for (const Camera& key : path.keys) {
      EXPECT_EQ(key.orthographic_height.has_value(), parallel);
      EXPECT_LT(glm::distance(key.eye, path.keys[0].eye), 1e-9);
      EXPECT_NEAR(key.orthographic_height.value_or(0.0), path.keys[0].orthographic_height.value_or(0.0), 1e-12);
    }
    session_.state().notices.clear();
    perform({{"do", "save_scene"}, {"file", folder_.path("saved.json").string()}});
    EXPECT_EQ(read_scene(folder_.path("saved.json")).paths.at("mine").keys.size(), 7U);
    perform({{"do", "seek"}, {"name", "mine"}, {"frame", 5}});
    EXPECT_EQ(height() > 0.0, parallel);
  }
}

}  // namespace
}  // namespace occlod::viewer
