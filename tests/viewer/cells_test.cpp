// View cells in a session: what is drawn, told and coloured while one walks through them.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <map>

#include "cell_walk.h"
#include "occlod/base.h"
#include "setting_table.h"
#include "viewer/support.h"

namespace occlod::viewer {
namespace {

using nlohmann::json;
using test::act;

std::vector<Triangle> sorted(std::vector<Triangle> triangles) {
  std::sort(triangles.begin(), triangles.end(),
            [](const Triangle& a, const Triangle& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
  return triangles;
}

class CellsSession : public ::testing::Test {
 protected:
  void SetUp() override {
    open(folder_.write("city.json", test::street_scene()));
    file_ = test::write_street_cells(folder_, *session_.state().objects);
  }
  void open(const std::filesystem::path& file) { act(session_, {{"do", "open"}, {"file", file.string()}}); }
  void walk() {
    open(file_);
    ASSERT_TRUE(session_.state().cells) << last_notice();
    ASSERT_TRUE(session_.frame()->cells) << last_notice();
  }
  void set(const char* setting, const json& value) {
    act(session_, {{"do", "set"}, {"setting", setting}, {"value", value}});
  }
  void stand_at(double x) { act(session_, {{"do", "camera"}, {"eye", {x, 181, 1.7}}, {"target", {x + 200, 180, 8}}}); }
  [[nodiscard]] std::string last_notice() const {
    return session_.state().notices.empty() ? "" : session_.state().notices.back().text;
  }
  [[nodiscard]] double figure(const char* name) const { return session_.figures().at(name); }
  [[nodiscard]] const CellsFrame& told() const { return *session_.frame()->cells; }
  [[nodiscard]] const RefinedSide& side() const { return session_.frame()->sides.at(0); }
  [[nodiscard]] const VlodFile& vlod() const { return *session_.state().cells->file; }
  // Of the only object, as the file has it for the cell where the eye is.
  [[nodiscard]] CellObjectCut cut() const {
    const CellId leaf = vlod().tree().leaf_of(session_.state().camera.eye);
    return read_cell(vlod(), refine_objects(*session_.state().objects), leaf).at(0);
  }

  test::Folder folder_;
  std::filesystem::path file_;
  Session session_{test::make_portable_visibility, false};
};

TEST_F(CellsSession, DrawTheCellOfTheEye) {
  const double refined = figure("triangles");
  walk();
  EXPECT_EQ(figure("cells"), vlod().tree().leaf_count());
  for (const double x : {65.0, 75.0, 95.0}) {
    stand_at(x);
    EXPECT_EQ(figure("cell"), vlod().tree().leaf_of(session_.state().camera.eye));
    EXPECT_EQ(figure("shown_cell"), figure("cell"));
    EXPECT_EQ(sorted(side().refinement.objects[0].triangles), sorted(cut().triangles)) << x;
    EXPECT_EQ(figure("triangles"), static_cast<double>(cut().triangles.size()));
    EXPECT_LE(figure("max_error_px"), vlod().options().cell.tolerance_px);
  }
  EXPECT_EQ(figure("crossings"), 2.0);
  set("walk_cells", false);
  EXPECT_FALSE(session_.frame()->cells);
  stand_at(65.0);
  EXPECT_NE(figure("triangles"), refined);  // no longer the default view
  set("walk_cells", true);
  act(session_, {{"do", "close_cells"}});
  EXPECT_FALSE(session_.frame()->cells);
}

// What `occlod cells walk` tells of the same path.
TEST_F(CellsSession, PathsAreThoseOfTheCommandLine) {
  walk();
  const CameraPath path = session_.state().paths.at("by");
  for (const bool prefetch : {true, false}) {
    set("cells_prefetch", prefetch);
    act(session_, {{"do", "play"}, {"name", "by"}});
    while (!session_.state().playback.path.empty()) test::settle(session_);
    const CellsFrame& walked = told();
    tool::CellWalkOptions options;
    options.prefetch = prefetch;
    tool::CellWalk walk(session_.state().cells->file, refine_objects(*session_.state().objects), options);
    std::size_t frames = 0, late = 0, crossings = 0, loads = 0;
    std::uint64_t bytes = 0;
    // At the end it stands until the cell is there.
    for (int i = 0; i < path.frames || walk.walked().late; ++i, ++frames) {
      const WalkedFrame& frame = walk.step_to(camera_at(path, std::min(i, path.frames - 1)));
      late += frame.late ? 1U : 0U;
      crossings += frame.crossed && i > 0 ? 1U : 0U;
      loads += frame.loads;
      bytes += frame.bytes_read;
    }
    EXPECT_EQ(walked.frames, frames);
    EXPECT_EQ(walked.late, late);
    EXPECT_EQ(walked.crossings, crossings);
    EXPECT_EQ(walked.loads, loads);
    EXPECT_EQ(walked.bytes_read, bytes);
    EXPECT_GT(crossings, 0U);
    EXPECT_GT(bytes, 0U);
  }
}

// A disk of ten kilobytes a second: the node above is drawn until the cell has come.
TEST_F(CellsSession, ASlowDiskIsLate) {
  walk();
  EXPECT_LE(figure("late_frames"), 1.0);
  set("cells_prefetch", false);
  set("cells_latency", 200.0);
  set("cells_disk", 1.0);
  stand_at(65.0);
  const double before = figure("late_frames");
  stand_at(95.0);
  // Each of the nodes below the common one takes at least 12 frames of a sixtieth of a second.
  EXPECT_GE(figure("late_frames") - before, 12.0);
  EXPECT_EQ(figure("shown_cell"), figure("cell"));  // the view is drawn until it is there
  EXPECT_EQ(told().visits.at(static_cast<CellId>(figure("cell"))).late, figure("late_frames") - before);
  const CellScale scale{};
  EXPECT_EQ(box_color(told(), told().walked.cell, CellBoxes::late, scale), color_of(CellArrival::late));
  const CellId last = session_.state().cells->leaves.back();
  EXPECT_EQ(told().visits.count(last), last == told().walked.cell ? 1U : 0U);
}

TEST_F(CellsSession, MemoryIsALimit) {
  walk();
  set("cells_memory", 0.01);
  EXPECT_EQ(session_.frame()->side_count(), 0U);
  EXPECT_NE(last_notice().find("memory"), std::string::npos) << last_notice();
  set("cells_memory", 64.0);
  ASSERT_TRUE(session_.frame()->cells);
  EXPECT_LE(figure("resident_bytes"), 64e6);
  EXPECT_GT(figure("resident_bytes"), 0.0);
}

// Every active triangle of the cut has one colour, for a reason that is checked here in another way.
TEST_F(CellsSession, ColoursTellWhatIsKept) {
  walk();
  set("cells_color_by", "kept");
  set("cells_left_out", true);
  const CellNode& node = vlod().tree().node(static_cast<CellId>(figure("cell")));
  const std::vector<Triangle>& triangles = side().refinement.objects[0].triangles;
  const std::vector<glm::u8vec4>& colors = side().colors[0];
  ASSERT_EQ(colors.size(), triangles.size());
  EXPECT_EQ(triangles.size(), node.triangles);
  EXPECT_EQ(figure("left_out"), static_cast<double>(node.triangles - node.drawn_triangles));
  const std::span<const glm::vec3> positions = session_.state().objects->at(0).mesh->hierarchy->positions();
  std::map<std::string, double> counts;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const glm::dvec3 a(positions[triangles[i].x]), b(positions[triangles[i].y]), c(positions[triangles[i].z]);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    bool away = true;
    for (int k = 0; k < 8; ++k) {
      const glm::dvec3 eye((k & 1) != 0 ? node.box.max.x : node.box.min.x,
                           (k & 2) != 0 ? node.box.max.y : node.box.min.y,
                           (k & 4) != 0 ? node.box.max.z : node.box.min.z);
      away = away && glm::dot(normal, eye - a) <= 0.0;
    }
    if (colors[i] == color_of(CellKept::seen)) {
      ++counts["seen"];
      EXPECT_FALSE(away);
    } else if (colors[i] == color_of(CellKept::unseen)) {
      ++counts["unseen"];
    } else if (colors[i] == color_of(CellKept::facing_away)) {
      ++counts["facing away"];
      EXPECT_TRUE(away);
    } else {
      ASSERT_EQ(colors[i], color_of(CellKept::hidden));
      ++counts["hidden"];
    }
  }
  EXPECT_EQ(counts["seen"], figure("visible_triangles"));
  EXPECT_EQ(counts["seen"] + counts["unseen"], figure("triangles"));
  for (const char* kind : {"seen", "unseen", "facing away", "hidden"}) EXPECT_GT(counts[kind], 0.0) << kind;

  set("cells_left_out", false);
  EXPECT_EQ(side().refinement.objects[0].triangles.size(), node.drawn_triangles);
  EXPECT_EQ(figure("left_out"), 0.0);
}

// By error: within the tolerance where the view is that of the cells.
TEST_F(CellsSession, ColoursTellErrors) {
  walk();
  set("cells_color_by", "error");
  std::size_t exact = 0, total = 0;
  for (const glm::u8vec4& color : side().colors[0]) {
    exact += color == error_color(0.0) ? 1U : 0U;
    ++total;
  }
  EXPECT_EQ(total, side().refinement.objects[0].triangles.size());
  EXPECT_GT(exact, 0U);
  EXPECT_LT(exact, total);
}

TEST_F(CellsSession, FreezeKeepsTheCell) {
  walk();
  set("freeze", true);
  const double frames = figure("walked_frames"), cell = figure("cell"), triangles = figure("triangles");
  act(session_, {{"do", "go_to"}, {"name", "above"}});
  EXPECT_EQ(figure("walked_frames"), frames);
  EXPECT_EQ(figure("cell"), cell);
  EXPECT_EQ(figure("triangles"), triangles);
  set("freeze", false);
  EXPECT_EQ(figure("outside"), 1.0);
}

// Left the cell, right a refinement of the same view.
TEST_F(CellsSession, SplitScreenRefinesBesideIt) {
  act(session_, {{"do", "picture_size"}, {"width", 160}, {"height", 120}});
  set("frame_to_frame", false);
  set("budget", 5000);
  const std::uint64_t refined = session_.frame()->hash;
  walk();
  set("compare", true);
  ASSERT_EQ(session_.frame()->sides.size(), 2U);
  EXPECT_EQ(session_.frame()->sides[1].refinement.hash(), refined);
  EXPECT_EQ(sorted(side().refinement.objects[0].triangles), sorted(cut().triangles));
}

TEST_F(CellsSession, BelongToTheirObjects) {
  walk();
  act(session_, {{"do", "select"}, {"object", session_.state().objects->at(0).name}});
  act(session_, {{"do", "place"}, {"position", {1, 0, 0}}});
  EXPECT_FALSE(session_.cells_fit());
  EXPECT_FALSE(session_.frame()->cells);
  EXPECT_GT(figure("triangles"), 0.0);  // refined
  act(session_, {{"do", "place"}, {"position", {0, 0, 0}}});
  EXPECT_TRUE(session_.frame()->cells);
  act(session_, {{"do", "close_all"}});
  EXPECT_FALSE(session_.state().cells);
}

TEST_F(CellsSession, OfAnotherSceneAreRefused) {
  act(session_, {{"do", "close_all"}});
  act(session_, {{"do", "open"}, {"file", file_.string()}});
  EXPECT_NE(last_notice().find("no scene is open"), std::string::npos) << last_notice();
  open(folder_.write("planet.json", test::planet_scene(4)));
  const int errors = session_.state().errors;
  open(file_);
  EXPECT_EQ(session_.state().errors, errors + 1);
  EXPECT_NE(last_notice().find(file_.string()), std::string::npos) << last_notice();
  EXPECT_FALSE(session_.state().cells);
}

// Larger pictures magnify more than the cells were built for.
// The picture of the viewer is a little wider than what cells are built for by default, or larger in a large window.
TEST_F(CellsSession, OpenWithAPictureThatTheyWereBuiltFor) {
  for (const ImageSize& window : {ImageSize{190, 120}, ImageSize{1110, 750}, ImageSize{160, 120}}) {
    act(session_, {{"do", "close_cells"}});
    session_.set_view_size(window);
    walk();
    EXPECT_EQ(figure("promised"), 1.0) << window.width;
    EXPECT_EQ(session_.state().camera.width, 160);  // as built: see support.cpp
    EXPECT_EQ(session_.state().camera.height, 120);
    act(session_, {{"do", "go_to"}, {"name", "default"}});
    EXPECT_EQ(figure("promised"), 1.0);
  }
  act(session_, {{"do", "close_cells"}});
  session_.set_view_size({1110, 750});
  EXPECT_EQ(session_.state().camera.width, 1110);
}

TEST_F(CellsSession, SayWhyTheyDoNotPromise) {
  walk();
  const ViewCells& cells = *session_.state().cells;
  Camera camera = session_.state().camera;
  EXPECT_EQ(why_not_promised(cells, camera), "");
  for (const auto& [words, change] : std::initializer_list<std::pair<const char*, void (*)(Camera&)>>{
           {"magnifies 2 times", [](Camera& c) { c.width = 320, c.height = 240; }},
           {"corner to corner", [](Camera& c) { c.width = 200; }},
           {"near plane", [](Camera& c) { c.near = 0.1; }},
           {"orthographic", [](Camera& c) { c.orthographic_height = 10.0; }}}) {
    Camera other = camera;
    change(other);
    EXPECT_NE(why_not_promised(cells, other).find(words), std::string::npos) << why_not_promised(cells, other);
  }
}

TEST_F(CellsSession, SayWhereTheyPromise) {
  walk();
  act(session_, {{"do", "picture_size"}, {"width", 160}, {"height", 120}});
  EXPECT_EQ(figure("promised"), 1.0);
  act(session_, {{"do", "picture_size"}, {"width", 320}, {"height", 240}});
  EXPECT_EQ(figure("promised"), 0.0);
}

TEST_F(CellsSession, AreNotOverwritten) {
  walk();
  const std::string from = "test";
  const json action = {{"do", "screenshot"}, {"file", file_.string()}};
  EXPECT_THROW(session_.perform(JsonPlace(action, from)), Error);
}

TEST_F(CellsSession, BoxesAreColouredByTheirScale) {
  walk();
  const ViewCells& cells = *session_.state().cells;
  for (const CellBoxes boxes : {CellBoxes::triangles, CellBoxes::bytes}) {
    const CellScale scale = scale_of(cells, boxes);
    std::map<double, CellId> leaves;
    for (const CellId leaf : cells.leaves)
      leaves[boxes == CellBoxes::bytes ? static_cast<double>(cells.path_bytes[leaf])
                                       : static_cast<double>(vlod().tree().node(leaf).drawn_triangles)] = leaf;
    ASSERT_GT(leaves.size(), 1U);
    EXPECT_EQ(scale.least, leaves.begin()->first);
    EXPECT_EQ(scale.most, leaves.rbegin()->first);
    EXPECT_EQ(box_color(told(), leaves.begin()->second, boxes, scale), level_color(0.0));
    EXPECT_EQ(box_color(told(), leaves.rbegin()->second, boxes, scale), level_color(1.0));
    EXPECT_EQ(legend_of(cells, boxes).size(), 3U);
  }
  // A jump to a leaf reads its path.
  std::vector<CellId> path;
  vlod().tree().path_to(cells.leaves.back(), path);
  std::uint64_t bytes = 0;
  for (const CellId node : path) bytes += vlod().tree().node(node).payload_bytes;
  EXPECT_EQ(cells.path_bytes[cells.leaves.back()], bytes);
  // The nearest ones.
  const CellBox& first = vlod().tree().node(cells.leaves.front()).box;
  EXPECT_EQ(nearest_leaves(cells, 0.5 * (first.min + first.max), 1), std::vector<CellId>{cells.leaves.front()});
}

}  // namespace
}  // namespace occlod::viewer
