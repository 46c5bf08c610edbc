#include "session.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <glm/geometric.hpp>

#include "occlod/auto_refiner.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/scene.h"
#include "occlod/visibility.h"
#include "palette.h"
#include "view_cells.h"
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
  set("frame_to_frame", false);    // splits that are applied may stay where larger errors elsewhere find no room
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
  set("frame_to_frame", false);  // both sides of the same age
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
TEST_F(SessionTest, ObjectsOfOneNameAreToldApart) {
  json scene = test::planet_scene(3);
  scene["objects"] = {scene["objects"][0], scene["objects"][0]};
  open(scene);
  act(session_, {{"do", "open"}, {"file", folder_.path("planet.json").string()}});
  std::vector<std::string> names;
  for (const PlacedObject& object : *session_.state().objects) names.push_back(object.name);
  ASSERT_EQ(names.size(), 4U);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(names[i], fmt::format("{} ({})", names[0], i + 1));
  act(session_, {{"do", "close"}, {"object", names[1]}});
  act(session_, {{"do", "select"}, {"object", names[3]}});
  EXPECT_EQ(session_.state().selected, session_.state().objects->at(2).id);
}

TEST_F(SessionTest, MissingImagesAreToldInTheWindow) {
  std::ofstream(folder_.path("a.mtl"))
      << "newmtl a\nmap_Kd nowhere.png\nnewmtl b\nmap_Kd b.png\nnewmtl c\nmap_Kd c.png\n";
  std::ofstream(folder_.path("a.obj")) << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                                          "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 2/2\nusemtl c\nf 2/2 3/3 1/1\n";
  act(session_, {{"do", "open"}, {"file", folder_.path("a.obj").string()}});
  const auto& notices = session_.state().notices;
  ASSERT_EQ(notices.size(), 3U);
  EXPECT_NE(notices[0].text.find("nowhere.png"), std::string::npos) << notices[0].text;
  EXPECT_NE(notices[1].text.find("b.png"), std::string::npos) << notices[1].text;
  EXPECT_NE(notices[2].text.find("1 more"), std::string::npos) << notices[2].text;
  for (const Notice& notice : notices) EXPECT_TRUE(notice.is_warning && !notice.is_error);
  EXPECT_EQ(session_.state().errors, 0);
}

TEST_F(SessionTest, UnknownEndingsAreToldWithAllThatCanBeOpened) {
  act(session_, {{"do", "open"}, {"file", folder_.write("planet.max", json::object()).string()}});
  ASSERT_EQ(session_.state().notices.size(), 1U);
  for (const char* ending : {"planet.max", ".ply", ".glb", ".olod", ".ohlod", ".json", ".vlod"})
    EXPECT_NE(session_.state().notices[0].text.find(ending), std::string::npos) << session_.state().notices[0].text;
}

// Numbers stand beside the first picture already, not only beside the second.
TEST_F(SessionTest, TheFirstPictureHasItsNumbers) {
  session_.perform(json{{"do", "open"}, {"file", folder_.write("planet.json", test::planet_scene()).string()}});
  while (!session_.frame()) session_.update(0.25, 100.0);
  ASSERT_TRUE(session_.timeline().records().empty());
  const PictureRecord shown = session_.record_of_frame();
  EXPECT_EQ(shown.triangles, stats().triangles);
  EXPECT_EQ(shown.hash, session_.frame()->hash);
  session_.picture_drawn({});
  const PictureRecord& kept = session_.timeline().records().at(0);
  EXPECT_EQ(kept.triangles, shown.triangles);
  EXPECT_EQ(kept.at_s, shown.at_s);
  EXPECT_GE(kept.at_s, 0.25);
}

// 5, 10, 25, 50, 100, ... ms, however long a picture takes.
TEST(Graph, ContainsLongPictures) {
  std::deque<PictureRecord> records(10);
  for (const auto& [ms, top] : {std::pair(0.0, 5.0), std::pair(5.0, 5.0), std::pair(5.1, 10.0), std::pair(30.0, 50.0),
                                std::pair(4900.0, 5000.0), std::pair(26'000.0, 50'000.0), std::pair(3e6, 5e6)}) {
    for (PictureRecord& record : records) record.refine_ms = ms;
    EXPECT_DOUBLE_EQ(graph_top_ms(records, 0), top) << ms;
  }
}

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

// The meshes of the path "by", played.
std::vector<std::uint64_t> played(Session& session) {
  session.perform(json{{"do", "play"}, {"name", "by"}});
  std::vector<std::uint64_t> hashes;
  while (true) {
    session.update(0.01, 1000.0);
    if (session.state().playback.path.empty()) break;
    if (!session.is_current()) continue;
    const auto frame = static_cast<std::size_t>(session.state().playback.at);
    if (hashes.size() == frame) hashes.push_back(session.frame()->hash);
    session.picture_drawn({});
  }
  test::settle(session);
  return hashes;
}

// The same by the library alone.
std::vector<std::uint64_t> refined(const Session& session, const RefineOptions& options, bool frame_to_frame) {
  const PlacedObject& object = session.state().objects->at(0);
  const RefineObject objects[] = {{object.mesh->hierarchy.get(), object.object_to_world, object.two_sided}};
  Refiner refiner(objects);
  const auto software = make_software_occlusion();
  std::vector<std::uint64_t> hashes;
  for (int i = 0; i < 5; ++i) {
    const View view(camera_at(session.state().paths.at("by"), i));
    hashes.push_back(frame_to_frame ? refiner.update(view, options, *software).hash()
                                    : refiner.refine(view, options, *software).hash());
  }
  return hashes;
}

// What a command-line replay does: the same cameras, options and backend give the same triangles.
TEST_F(SessionTest, ReplayedPathGivesTheMeshesOfTheLibrary) {
  open();
  set("budget", 2000);
  set("frame_to_frame", false);
  const std::vector<std::uint64_t> hashes = played(session_);
  EXPECT_EQ(hashes, refined(session_, session_.state().settings.refine, false));
  EXPECT_NE(hashes[0], hashes[4]);
}

// Frame to frame as well, whatever was looked at before, and though each frame leaves work over.
TEST_F(SessionTest, ReplayedPathGivesTheFramesOfTheLibrary) {
  open();
  set("budget", 2000);
  for (const int max_changes : {0, 30}) {
    set("max_changes", max_changes);
    const std::vector<std::uint64_t> expected = refined(session_, session_.state().settings.refine, true);
    EXPECT_EQ(played(session_), expected);
    act(session_, {{"do", "orbit"}, {"right", 40}, {"up", 10}});
    EXPECT_EQ(played(session_), expected);
    EXPECT_NE(expected, refined(session_, session_.state().settings.refine, false));
  }
}

// What a replay by `render --frame-to-frame --occlusion picture` does: each frame's picture stands for the next one's
// occluder.
TEST_F(SessionTest, PicturesAreShownToTheNextFrame) {
  open();
  set("budget", 2000);
  set("occlusion", "picture");
  set("count_visible", false);
  const PlacedObject& object = session_.state().objects->at(0);
  const RefineObject objects[] = {{object.mesh->hierarchy.get(), object.object_to_world, object.two_sided}};
  Refiner refiner(objects);
  const auto software = make_software_occlusion();
  ItemBuffer items;
  std::vector<std::uint64_t> expected;
  for (int i = 0; i < 5; ++i) {
    const View view(camera_at(session_.state().paths.at("by"), i));
    const Refinement& frame = refiner.update(view, session_.state().settings.refine, *software);
    expected.push_back(frame.hash());
    items.reset(view.width(), view.height());
    const DrawObject drawn[] = {
        {object.mesh->hierarchy->positions(), {}, frame.objects[0].triangles, object.object_to_world}};
    draw_items(items, drawn, view);
    software->show(items.depth);
  }
  EXPECT_EQ(played(session_), expected);
  EXPECT_NE(expected, refined(session_, session_.state().settings.refine, true));
  act(session_, {{"do", "orbit"}, {"right", 40}, {"up", 10}});
  EXPECT_EQ(played(session_), expected);
}

// What AutoRefiner chooses for the frames of the path "by", with the calibration that the session measured.
TEST_F(SessionTest, AutoChoosesAsTheLibraryDoes) {
  open();
  set("budget", 2000);
  set("occlusion", "auto");
  const std::shared_ptr<const Explanation> first = session_.frame()->sides[0].explanation;
  ASSERT_TRUE(first);
  EXPECT_TRUE(first->report.looked_ahead);
  EXPECT_GT(session_.figures().at("look_ms"), 0.0);
  EXPECT_GE(stats().refine_ms, first->report.look_ms);
  for (const bool frame_to_frame : {true, false}) {
    set("frame_to_frame", frame_to_frame);
    const std::vector<std::uint64_t> hashes = played(session_);
    const PlacedObject& object = session_.state().objects->at(0);
    const RefineObject objects[] = {{object.mesh->hierarchy.get(), object.object_to_world, object.two_sided}};
    AutoRefiner refiner(objects, first->calibration);
    for (int i = 0; i < 5; ++i) {
      const View view(camera_at(session_.state().paths.at("by"), i));
      const RefineOptions& wanted = session_.state().settings.refine;
      const Refinement& expected = frame_to_frame ? refiner.update(view, wanted) : refiner.refine(view, wanted);
      EXPECT_EQ(hashes[static_cast<std::size_t>(i)], expected.hash()) << i;
    }
  }
  // Another backend is another refiner: nothing is left of the choice.
  set("occlusion", "software");
  EXPECT_FALSE(session_.frame()->sides[0].explanation);
  EXPECT_FALSE(session_.figures().contains("auto_asks"));
  EXPECT_EQ(session_.frame()->sides[0].follows, 0U);
}

// A limit of 50 changes a picture: the mesh follows over many pictures, and then nothing goes on.
TEST_F(SessionTest, WorkThatIsLeftOverIsDone) {
  open();
  act(session_, {{"do", "go_to"}, {"name", "far"}});
  set("budget", 1000);
  set("max_changes", 50);
  session_.perform(json{{"do", "set"}, {"setting", "budget"}, {"value", 3000}});
  std::size_t steps = 0;
  bool was_pending = false;
  for (std::uint64_t number = 0; !session_.settled(); session_.picture_drawn({})) {
    session_.update(0.01, 1000.0);
    if (!session_.is_current() || session_.frame()->job.number == number) continue;
    number = session_.frame()->job.number;
    was_pending = was_pending || stats().pending;
    EXPECT_LE(stats().new_splits + stats().merged_splits, 50U + 64U);  // one step may force a few more
    ++steps;
  }
  EXPECT_TRUE(was_pending);
  EXPECT_GT(steps, 5U);
  EXPECT_FALSE(stats().pending);
  EXPECT_EQ(session_.figures().at("pending"), 0.0);
  const auto last = session_.frame();
  for (int i = 0; i < 5; ++i) session_.update(0.01, 100.0);
  EXPECT_EQ(session_.frame(), last);  // the very same: nothing was refined
}

// From scratch nothing has aged: all but the base mesh has the colour of the last occluder. From frame to frame a part
// is asked about in each.
TEST_F(SessionTest, AgesAreOfTheLastAnswers) {
  open();
  act(session_, {{"do", "go_to"}, {"name", "far"}});
  set("budget", 3000);
  set("color_by", "age");
  set("frame_to_frame", false);
  for (const glm::u8vec4& color : session_.frame()->sides[0].colors[0])
    EXPECT_TRUE(color == age_color(0) || color == base_mesh_color);
  set("frame_to_frame", true);
  set("final_check", false);
  for (int i = 0; i < 3; ++i) act(session_, {{"do", "orbit"}, {"right", 0.3}, {"up", 0}});
  const std::vector<glm::u8vec4>& colors = session_.frame()->sides[0].colors[0];
  for (const std::uint32_t age : {0U, 1U, 2U})
    EXPECT_GT(std::count(colors.begin(), colors.end(), age_color(age)), 0) << age;
}

// Vertices that slide are on their way for as many pictures as asked for; then the picture is at rest.
TEST_F(SessionTest, GeomorphsArrive) {
  open();
  act(session_, {{"do", "go_to"}, {"name", "far"}});
  set("geomorph_frames", 6);
  session_.perform(json{{"do", "orbit"}, {"right", 4}, {"up", 0}});
  session_.update(0.01, 1000.0);
  ASSERT_TRUE(session_.is_current());
  EXPECT_FALSE(session_.frame()->sides[0].refinement.objects[0].geomorphs.empty());
  EXPECT_FALSE(session_.settled());
  test::settle(session_);
  EXPECT_TRUE(session_.frame()->sides[0].refinement.objects[0].geomorphs.empty());
}

// Asking what a mesh is good for is not asking for another mesh.
TEST_F(SessionTest, ExplanationsAreOfTheMeshThatIsThere) {
  open();
  act(session_, {{"do", "orbit"}, {"right", 5}, {"up", 0}});
  const std::uint64_t number = session_.frame()->sides[0].number;
  for (const char* by : {"level", "error", "visibility", "outcome", "age"}) {
    set("color_by", by);
    const RefinedSide& side = session_.frame()->sides[0];
    EXPECT_EQ(side.colors[0].size(), side.refinement.objects[0].triangles.size()) << by;
    EXPECT_EQ(side.number, number) << by;
  }
  set("color_by", "plain");
  EXPECT_EQ(session_.frame()->sides[0].occluder, nullptr);
  set("occluder", true);
  EXPECT_NE(session_.frame()->sides[0].occluder, nullptr);  // though none has been drawn since it was asked for
  EXPECT_EQ(session_.frame()->sides[0].number, number);
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

// "attributes": false reaches refinement, and is there again when the scene is saved.
TEST_F(SessionTest, KeepsWhatMaySlip) {
  json scene = test::planet_scene(2);
  scene["objects"][0]["attributes"] = false;
  act(session_, {{"do", "open"}, {"file", folder_.write("free.json", scene).string()}});
  ASSERT_EQ(session_.state().objects->size(), 1U);
  EXPECT_FALSE(refine_objects(*session_.state().objects)[0].attributes);
  act(session_, {{"do", "save_scene"}, {"file", folder_.path("saved.json").string()}});
  EXPECT_FALSE(read_scene(folder_.path("saved.json")).objects.at(0).attributes);
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

// Numbers that no image can be made with change nothing.
TEST_F(SessionTest, NumbersOutOfRangeAreRefused) {
  open();
  const Camera before = session_.state().camera;
  const glm::dmat4 place = session_.state().objects->at(0).object_to_world;
  const std::uint64_t id = session_.state().objects->at(0).id;
  for (const json& action :
       {json{{"do", "pan"}, {"right", 1e308}, {"up", 1e308}}, json{{"do", "move"}, {"ahead", -1e308}, {"seconds", 1}},
        json{{"do", "camera"}, {"eye", {1e308, 0, 0}}}, json{{"do", "zoom"}, {"factor", -1}},
        json{{"do", "zoom"}, {"factor", 1e300}}, json{{"do", "window_size"}, {"width", 100'000}, {"height", 900}},
        json{{"do", "picture_size"}, {"width", 100'000}, {"height", 900}},
        json{{"do", "place"}, {"object", id}, {"position", {1e300, 0, 0}}},
        json{{"do", "place"}, {"object", id}, {"scale", 1e300}}}) {
    EXPECT_THROW(act(session_, action), Error) << action;
    EXPECT_EQ(session_.state().camera, before) << action;
    EXPECT_EQ(session_.state().objects->at(0).object_to_world, place) << action;
  }
  act(session_, {{"do", "orbit"}, {"right", 1e300}, {"up", 1e300}});  // an angle is an angle
  EXPECT_TRUE(session_.frame());
}

// A backend that this machine does not have.
TEST(SessionBackend, FailureIsToldAndCanBeLeft) {
  const test::Folder folder;
  Session session(
      [](Occlusion occlusion) {
        if (occlusion == Occlusion::gl_query) throw Error({"gl-query", "", "has no OpenGL context", "use software"});
        return test::make_portable_visibility(occlusion);
      },
      false);
  act(session, {{"do", "open"}, {"file", folder.write("planet.json", test::planet_scene()).string()}});
  act(session, {{"do", "set"}, {"setting", "occlusion"}, {"value", "gl-query"}});
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
  const auto below = cast_ray(*session_.frame(), {camera.eye, {0.0, -1.0, 0.0}});
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

TEST(SessionOnAMap, PicksAndSavesInWorldCoordinates) {
  // A square of 2 m, on a map where floats are 0.5 m apart.
  const test::Folder folder;
  const glm::dvec3 corner(691607.37, 5334760.81, 519.93);
  std::string text;
  for (const glm::dvec3& p : {glm::dvec3(0, 0, 0), glm::dvec3(2, 0, 0), glm::dvec3(2, 2, 0), glm::dvec3(0, 2, 0)})
    text += fmt::format("v {} {} {}\n", corner.x + p.x, corner.y + p.y, corner.z + p.z);
  std::ofstream(folder.path("map.obj")) << text << "f 1 2 3 4\n";
  const auto camera = [&](double x) -> json {
    return {{"eye", {corner.x + x, corner.y + 1.3, corner.z + 4.0}},
            {"target", {corner.x + x, corner.y + 1.3, corner.z}},
            {"up", {0, 1, 0}},
            {"near", 0.1},
            {"far", 100},
            {"width", 100},
            {"height", 100}};
  };
  const auto scene = folder.write("map.json", {{"objects", {{{"mesh", "map.obj"}, {"position", {0.25, 0, 0}}}}},
                                               {"cameras", {{"default", camera(0.7)}}}});
  for (const char* as : {"hierarchy", "hlod"}) {
    Session session{test::make_portable_visibility, false};
    act(session, {{"do", "set"}, {"setting", "device"}, {"value", "software"}});
    act(session, {{"do", "set"}, {"setting", "open_as"}, {"value", as}});
    act(session, {{"do", "open"}, {"file", scene.string()}});
    ASSERT_EQ(session.state().objects->size(), 1U) << as;
    act(session, {{"do", "pick"}, {"x", 0.5}, {"y", 0.5}});
    ASSERT_TRUE(session.state().pick) << as;
    EXPECT_LT(glm::distance(session.state().pick->point, corner + glm::dvec3(0.7, 1.3, 0.0)), 1e-4) << as;
    const auto saved = folder.path("saved.json");
    act(session, {{"do", "save_scene"}, {"file", saved.string()}});
    EXPECT_LT(glm::distance(glm::dvec3(read_scene(saved).objects[0].object_to_world[3]), glm::dvec3(0.25, 0.0, 0.0)),
              1e-8)
        << as;
  }
}

}  // namespace
}  // namespace occlod::viewer
