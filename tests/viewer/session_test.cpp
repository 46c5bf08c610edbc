#include "session.h"

#include <gtest/gtest.h>

#include <fstream>
#include <glm/geometric.hpp>

#include "occlod/core/error.h"
#include "occlod/hierarchy/build.h"
#include "occlod/occlusion/software_occlusion.h"
#include "viewer/support.h"

namespace occlod::viewer {
namespace {

using nlohmann::json;
using test::act;

class SessionTest : public ::testing::Test {
 protected:
  void open(const json& scene = test::planet_scene()) {
    act(session_, {{"do", "open"}, {"file", folder_.write("planet.json", scene).string()}});
    ASSERT_TRUE(session_.frame()) << (session_.state().notices.empty() ? "" : session_.state().notices.back().text);
  }
  void set(const char* setting, const json& value) {
    act(session_, {{"do", "set"}, {"setting", setting}, {"value", value}});
  }
  [[nodiscard]] const RefineStats& stats() const { return session_.frame()->sides.at(0).refinement.stats; }

  test::Folder folder_;
  Session session_{test::make_portable_visibility, false};
};

TEST_F(SessionTest, OpensASceneAtItsDefaultCamera) {
  open();
  EXPECT_EQ(session_.state().objects->size(), 1U);
  EXPECT_EQ(session_.state().camera.eye, glm::dvec3(0.0, 1.3, 0.3));
  EXPECT_TRUE(session_.state().bookmarks.contains("far"));
  EXPECT_TRUE(session_.state().paths.contains("by"));
  EXPECT_EQ(session_.state().recent.size(), 1U);
}

TEST_F(SessionTest, EveryChangeIsThereInTheNextMesh) {
  open();
  set("budget", 1000);
  EXPECT_LE(stats().triangles, 1000U);
  EXPECT_GT(stats().triangles, 900U);
  set("budget", 3000);
  EXPECT_GT(stats().triangles, 2900U);
  set("occlusion", "none");
  EXPECT_EQ(stats().queries, 0U);
  set("occlusion", "software");
  EXPECT_GT(stats().queries, 0U);
  set("occluder_splits", json({1'000'000}));
  EXPECT_EQ(stats().queries, 0U);  // nothing is asked where no occluder is drawn
  set("tolerance", 16.0);
  EXPECT_LT(stats().triangles, 2900U);
}

// The paper's figures 4 and 7: look from elsewhere at what was refined for here.
TEST_F(SessionTest, FrozenMeshStaysWhileTheCameraFlies) {
  open();
  const std::uint64_t before = session_.frame()->hash;
  set("freeze", true);
  act(session_, {{"do", "orbit"}, {"right", 90}, {"up", 20}});
  EXPECT_EQ(session_.frame()->hash, before);
  EXPECT_NE(session_.state().camera.eye, session_.refine_camera().eye);
  set("freeze", false);
  EXPECT_NE(session_.frame()->hash, before);
}

TEST_F(SessionTest, SplitScreenHasTheSameBudgetWithoutOcclusion) {
  open();
  set("budget", 2000);
  set("compare", true);
  ASSERT_EQ(session_.frame()->sides.size(), 2U);
  const RefinedSide& without = session_.frame()->sides[1];
  EXPECT_EQ(without.refinement.stats.budget, stats().budget);
  EXPECT_EQ(without.refinement.stats.queries, 0U);
  // Near the ground of a planet most of what is refined without occlusion is behind hills.
  EXPECT_LT(without.visible_triangles, session_.frame()->sides[0].visible_triangles);
}

TEST_F(SessionTest, ObjectsAreMovedShownAndClosed) {
  open();
  act(session_, {{"do", "bookmark"}, {"name", "here"}});
  act(session_, {{"do", "open"}, {"file", folder_.path("planet.json").string()}});
  ASSERT_EQ(session_.state().objects->size(), 2U);
  const std::uint64_t second = session_.state().objects->back().id;
  act(session_, {{"do", "place"}, {"object", second}, {"position", {3, 0, 0}}, {"rotation", {0, 90, 0}}, {"scale", 2}});
  const PlacedObject& placed = session_.state().objects->back();
  EXPECT_EQ(glm::dvec3(placed.object_to_world[3]), glm::dvec3(3.0, 0.0, 0.0));
  EXPECT_NEAR(glm::length(glm::dvec3(placed.object_to_world[0])), 2.0, 1e-12);
  EXPECT_EQ(session_.frame()->job.objects->size(), 2U);
  act(session_, {{"do", "show"}, {"object", second}, {"shown", false}});
  EXPECT_EQ(session_.frame()->job.objects->size(), 1U);
  act(session_, {{"do", "close"}, {"object", second}});
  EXPECT_EQ(session_.state().objects->size(), 1U);
  act(session_, {{"do", "close_all"}});
  EXPECT_FALSE(session_.frame());
}

// As many pixels as the cursor has moved, at the object's own distance.
TEST_F(SessionTest, DraggedObjectFollowsTheCursor) {
  open();
  act(session_, {{"do", "go_to"}, {"name", "far"}});
  act(session_, {{"do", "pick"}, {"x", 0.5}, {"y", 0.5}});
  ASSERT_NE(session_.state().selected, 0U);
  const auto place = [&] {
    const glm::dvec4 clip =
        View(session_.state().camera).world_to_clip() * session_.state().objects->at(0).object_to_world[3];
    return 0.5 + 0.5 * clip.x / clip.w;
  };
  const double before = place();
  act(session_, {{"do", "drag"}, {"right", 0.1}, {"up", 0.0}});
  EXPECT_NEAR(place() - before, 0.1, 0.005);  // the middle of the box is not quite that of the planet
}

TEST_F(SessionTest, PickFindsTheSplitThatMadeTheTriangle) {
  open();
  act(session_, {{"do", "pick"}, {"x", 0.5}, {"y", 0.9}});
  ASSERT_TRUE(session_.state().pick);
  EXPECT_EQ(session_.state().selected, session_.state().objects->at(0).id);
  act(session_, {{"do", "unpick"}});
  EXPECT_FALSE(session_.state().pick);
}

// What a command-line replay does: the same cameras, options and backend give the same triangles.
TEST_F(SessionTest, ReplayedPathGivesTheMeshesOfTheLibrary) {
  open();
  set("budget", 2000);
  session_.perform(json{{"do", "play"}, {"name", "by"}});
  std::vector<std::uint64_t> hashes;
  while (true) {
    session_.update(0.01, 1000.0);
    if (session_.state().playback.path.empty()) break;
    ASSERT_TRUE(session_.is_current());
    const int frame = static_cast<int>(session_.state().playback.at);
    if (hashes.size() == static_cast<std::size_t>(frame)) hashes.push_back(session_.frame()->hash);
    session_.picture_drawn(0.0, 0.0);
    ASSERT_LT(hashes.size(), 10U);
  }
  const PlacedObject& object = session_.state().objects->at(0);
  const RefineObject objects[] = {{object.mesh->hierarchy.get(), object.object_to_world, object.two_sided}};
  Refiner refiner(objects);
  const auto software = make_software_occlusion();
  RefineOptions options;
  options.budget = 2000;
  std::vector<std::uint64_t> expected;
  for (int i = 0; i < 5; ++i)
    expected.push_back(refiner.refine(View(camera_at(session_.state().paths.at("by"), i)), options, *software).hash());
  EXPECT_EQ(hashes, expected);
  EXPECT_NE(expected[0], expected[4]);
}

TEST_F(SessionTest, RecordedPathIsSavedAndReadAgain) {
  open();
  session_.perform(json{{"do", "record"}, {"name", "mine"}});
  for (int i = 0; i < 10; ++i) {
    session_.perform(json{{"do", "orbit"}, {"right", 5}, {"up", 0}});
    session_.update(1.0 / 30.0 + 1e-9, 1000.0);
  }
  act(session_, {{"do", "stop"}});
  const CameraPath path = session_.state().paths.at("mine");
  EXPECT_EQ(path.keys.size(), 11U);  // the first camera, and one for each thirtieth of a second
  EXPECT_EQ(path.frames, 11);
  act(session_, {{"do", "place"}, {"object", session_.state().objects->at(0).id}, {"position", {0.1, 0.2, 0.3}}});
  act(session_, {{"do", "save_scene"}, {"file", folder_.path("saved.json").string()}});
  const SceneDescription saved = read_scene(folder_.path("saved.json"));
  EXPECT_EQ(saved.objects.at(0).object_to_world, session_.state().objects->at(0).object_to_world);
  EXPECT_EQ(saved.paths.at("mine").keys.at(7).eye, path.keys.at(7).eye);
  EXPECT_EQ(saved.cameras.at("default").eye, session_.state().camera.eye);
}

TEST_F(SessionTest, BuildingIsCancelled) {
  const auto scene = folder_.write("large.json", test::planet_scene(9));  // seconds to build
  session_.perform(json{{"do", "open"}, {"file", scene.string()}});
  while (session_.loader().progress().done == 0.0) session_.update(0.01, 0.0);
  act(session_, {{"do", "cancel"}});
  EXPECT_TRUE(session_.state().objects->empty());
  EXPECT_EQ(session_.state().errors, 0);  // it is no failure
  open();                                 // and the next file opens
}

TEST_F(SessionTest, MistakesBecomeNotices) {
  session_.perform(json{{"do", "fly_away"}});
  EXPECT_EQ(session_.state().errors, 1);
  act(session_, {{"do", "open"}, {"file", folder_.path("missing.ply").string()}});
  EXPECT_EQ(session_.state().errors, 2);
  EXPECT_NE(session_.state().notices.back().text.find("missing.ply"), std::string::npos);
  open();
  EXPECT_THROW(act(session_, {{"do", "orbit"}, {"right", 5}}), Error);         // a parameter is missing
  EXPECT_THROW(act(session_, {{"do", "quit"}, {"now", true}}), Error);         // one too many
  EXPECT_THROW(act(session_, {{"do", "camera"}, {"fov_y_deg", 200}}), Error);  // no such image
  EXPECT_THROW(act(session_, {{"do", "go_to"}, {"name", "nowhere"}}), Error);
  EXPECT_EQ(session_.state().camera.fov_y_deg, 45.0);
}

// A backend that this machine does not have.
TEST(SessionBackend, FailureIsToldAndCanBeLeft) {
  const test::Folder folder;
  Session session(
      [](Occlusion occlusion) {
        if (occlusion == Occlusion::gl_compute) throw Error({"gl-compute", "", "needs OpenGL 4.3", "use software"});
        return test::make_portable_visibility(occlusion);
      },
      false);
  act(session, {{"do", "open"}, {"file", folder.write("planet.json", test::planet_scene()).string()}});
  act(session, {{"do", "set"}, {"setting", "occlusion"}, {"value", "gl-compute"}});
  EXPECT_EQ(session.state().errors, 1);
  act(session, {{"do", "set"}, {"setting", "occlusion"}, {"value", "software"}});
  EXPECT_EQ(session.state().errors, 1);
  EXPECT_EQ(session.frame()->sides.size(), 1U);
}

// On the ground: going ahead over hills keeps the height of the eye above what is below it.
TEST_F(SessionTest, WalkingFollowsTheGround) {
  open();
  set("steering", "walk");
  set("speed", 0.05);
  for (int i = 0; i < 20; ++i) act(session_, {{"do", "move"}, {"ahead", 1}, {"seconds", 0.1}});
  const Camera& camera = session_.state().camera;
  const auto below = cast_ray(*session_.frame(), camera.eye, {0.0, -1.0, 0.0});
  ASSERT_TRUE(below);
  EXPECT_NEAR(below->distance, session_.state().walking_height, 0.05);
  EXPECT_LT(camera.eye.z, 0.25);  // it went ahead
}

TEST_F(SessionTest, NumbersAreExported) {
  open();
  set("budget", 2000);
  act(session_, {{"do", "export_csv"}, {"file", folder_.path("numbers.csv").string()}});
  std::ifstream file(folder_.path("numbers.csv"));
  std::string names, line, last;
  std::getline(file, names);
  while (std::getline(file, line)) last = line;
  EXPECT_EQ(std::count(names.begin(), names.end(), ','), std::count(last.begin(), last.end(), ','));
  EXPECT_NE(last.find(",2000,"), std::string::npos);
}

}  // namespace
}  // namespace occlod::viewer
