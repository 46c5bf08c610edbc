// HLODs in a session, drawn on the rasteriser.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <set>

#include "occlod/base.h"
#include "occlod/device.h"
#include "occlod/node_store.h"
#include "occlod/scene.h"
#include "palette.h"
#include "setting_table.h"
#include "viewer/support.h"

namespace occlod::viewer {
namespace {

using nlohmann::json;
using test::act;

class HlodSession : public ::testing::Test {
 protected:
  void SetUp() override {
    file_ = test::write_city(folder_);
    scene_ = folder_.write("city.json", test::city_scene("city.ohlod"));
    set("device", "software");
  }
  void open() {
    act(session_, {{"do", "open"}, {"file", scene_.string()}});
    ASSERT_TRUE(session_.frame()) << last_notice();
    ASSERT_EQ(session_.frame()->hlod_sides.size(), 1U) << last_notice();
  }
  void set(const char* setting, const json& value) {
    act(session_, {{"do", "set"}, {"setting", setting}, {"value", value}});
  }
  [[nodiscard]] std::string last_notice() const {
    return session_.state().notices.empty() ? "" : session_.state().notices.back().text;
  }
  [[nodiscard]] const HlodSide& side(std::size_t i = 0) const { return session_.frame()->hlod_sides.at(i); }
  [[nodiscard]] const hlod::FrameStats& stats() const { return side().front->frame.stats; }
  [[nodiscard]] const hlod::Hlod& hlod() const { return *session_.state().objects->at(0).hlod->hlod; }

  test::Folder folder_;
  std::filesystem::path file_;
  std::filesystem::path scene_;
  Session session_{test::make_portable_visibility, false};
};

TEST_F(HlodSession, OpensLikeAMesh) {
  act(session_, {{"do", "open"}, {"file", file_.string()}});
  ASSERT_EQ(session_.state().objects->size(), 1U) << last_notice();
  EXPECT_EQ(session_.state().objects->at(0).name, "city");
  // The camera sees all of it.
  const SceneBounds bounds = bounds_of(*session_.state().objects);
  EXPECT_GT(glm::distance(session_.state().camera.eye, bounds.center), bounds.radius);
  EXPECT_GT(stats().drawn_nodes, 0U);
  const auto figures = session_.figures();
  EXPECT_EQ(figures.at("drawn_nodes"), static_cast<double>(stats().drawn_nodes));
  EXPECT_EQ(figures.at("triangles"), static_cast<double>(stats().drawn_triangles));
  std::size_t triangles = 0;
  for (const FrontObject& object : side().front->objects) triangles += object.triangles.size();
  EXPECT_EQ(triangles, stats().drawn_triangles);
}

// Reading tells how far it is, and may be ended.
TEST_F(HlodSession, ReadingTellsItsProgress) {
  std::vector<double> told;
  LoadOptions options;
  options.progress = [&](const std::string& what, double done) {
    EXPECT_NE(what.find("city.ohlod"), std::string::npos);
    told.push_back(done);
  };
  static_cast<void>(load_hlods(read_scene(scene_), folder_.path(""), options));
  EXPECT_GT(told.size(), 40U);
  EXPECT_EQ(told.front(), 0.0);
  EXPECT_GT(told.back(), 0.95);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
}

// Whatever is shown of it, while it gets finer and where it stays.
TEST_F(HlodSession, TheToleranceIsRaisedUntilTrianglesAreFew) {
  open();
  act(session_, {{"do", "go_to"}, {"name", "above"}});
  const std::size_t of_front = stats().drawn_triangles;
  const std::uint64_t hash = side().front->frame.front_hash;
  EXPECT_EQ(session_.figures().at("tolerance_px"), 1.0);
  for (const std::size_t most : {of_front / 2, of_front / 5, of_front / 20}) {
    session_.perform(json{{"do", "set"}, {"setting", "most_triangles"}, {"value", most}});
    do {
      session_.update(0.01, 1000.0);
      session_.picture_drawn({});
      ASSERT_LE(session_.is_current() ? stats().drawn_triangles : 0, most);
    } while (!session_.settled());
    EXPECT_GT(stats().drawn_triangles, most / 4) << most;
    EXPECT_GT(session_.figures().at("tolerance_px"), 1.0);
    EXPECT_EQ(session_.figures().at("tolerance_px"), side().tolerance_px);
  }
  set("most_triangles", of_front);
  EXPECT_EQ(session_.figures().at("tolerance_px"), 1.0);
  EXPECT_EQ(side().front->frame.front_hash, hash);
  set("most_triangles", 1000);
  EXPECT_GT(session_.figures().at("tolerance_px"), 1.0);
  set("most_triangles", 0);
  EXPECT_EQ(session_.figures().at("tolerance_px"), 1.0);
  EXPECT_EQ(side().front->frame.front_hash, hash);
}

// A large one begins coarse.
TEST_F(HlodSession, TheFirstFrameOfALargeOneIsCoarse) {
  open();
  set("most_triangles", hlod().data().input_triangle_count / 2);
  act(session_, {{"do", "close_all"}});
  session_.perform(json{{"do", "open"}, {"file", scene_.string()}});
  std::vector<double> tolerances;
  do {
    session_.update(0.01, 1000.0);
    session_.picture_drawn({});
    if (session_.is_current()) tolerances.push_back(side().tolerance_px);
  } while (!session_.settled());
  ASSERT_FALSE(tolerances.empty());
  EXPECT_EQ(tolerances.front(), 64.0);
  EXPECT_LT(tolerances.back(), 16.0);
  EXPECT_GT(tolerances.size(), 3U);
}

// Meshes come while the view stands still, within the budget, until there are those of the whole HLOD's front, and a
// damaged one is counted.
TEST_F(HlodSession, MeshesComeAndGo) {
  json scene = test::city_scene("city.ohlod");
  json& behind = scene["cameras"]["behind"] = scene["cameras"]["default"];  // the other half of the city
  scene["cameras"]["default"]["eye"] = behind["eye"] = {180, 181, 30};
  scene["cameras"]["default"]["target"] = {300, 181, 8};
  behind["target"] = {60, 181, 8};
  scene_ = folder_.write("halves.json", scene);
  open();
  set("strategy", "vfc");
  const std::uint64_t wanted = side().front->frame.front_hash;
  const std::size_t all = hlod().data().meshes.size(), of_front = stats().drawn_triangles;
  for (const std::size_t budget : {all, all / 4}) {
    hlod::CacheOptions cache;
    cache.budget_bytes = budget;
    Session paged{test::make_portable_visibility, false, {}, make_portable_device, cache};
    act(paged, {{"do", "set"}, {"setting", "device"}, {"value", "software"}});
    act(paged, {{"do", "set"}, {"setting", "strategy"}, {"value", "vfc"}});
    act(paged, {{"do", "open"}, {"file", scene_.string()}});
    ASSERT_TRUE(paged.frame() && paged.frame()->cache);
    const auto figures = paged.figures();
    EXPECT_EQ(figures.at("cache_budget_bytes"), static_cast<double>(budget));
    EXPECT_LE(figures.at("cache_resident_bytes"), static_cast<double>(budget));
    EXPECT_EQ(figures.at("cache_loading_bytes"), 0.0) << "it waits until all has come that may";
    EXPECT_GT(figures.at("cache_loads"), 0.0);
    EXPECT_EQ(figures.at("cache_failed"), 0.0);
    const hlod::Frame& frame = paged.frame()->hlod_sides[0].front->frame;
    EXPECT_EQ(frame.front_hash == wanted, budget == all);
    EXPECT_EQ(figures.at("cache_missing") == 0.0, budget == all);
    EXPECT_EQ(frame.stats.drawn_triangles == of_front, budget == all);
    act(paged, {{"do", "go_to"}, {"name", "behind"}});
    EXPECT_EQ(paged.figures().at("cache_evictions") > 0.0, budget < all);
  }
  EXPECT_FALSE(session_.frame()->cache) << "all of it is there";
}

TEST_F(HlodSession, AFileThatIsTooLargeForItsCacheIsToldInOneLine) {
  hlod::CacheOptions cache;
  cache.budget_bytes = 1;
  Session paged{test::make_portable_visibility, false, {}, make_portable_device, cache};
  act(paged, {{"do", "open"}, {"file", scene_.string()}});
  ASSERT_FALSE(paged.state().notices.empty());
  EXPECT_NE(paged.state().notices.back().text.find("at least"), std::string::npos);
  EXPECT_TRUE(paged.state().objects->empty());
}

// The first frame of a view is the library's for the same options: nothing is left out on the way.
TEST_F(HlodSession, EverySettingReachesTheTraverser) {
  open();
  set("settle", false);
  const std::vector<hlod::PlacedHlod> placed = placed_hlods(*session_.state().objects);
  const std::vector<std::pair<const char*, json>> changes = {
      {"strategy", "coh"},   {"hlod_tolerance", 4.0}, {"bias_s", 0.0},     {"bias_s", 0.6},      {"bias_t", 0.9},
      {"between", "within"}, {"between", "geomorph"}, {"strategy", "vfc"}, {"strategy", "nohc"}, {"strategy", "batch"}};
  std::set<std::uint64_t> hashes;
  for (const auto& [name, value] : changes) {
    session_.state().settings.hlod.boxes = NodeBoxes::none;
    act(session_, {{"do", "set"}, {"setting", name}, {"value", value}});
    // From scratch: the path's first frame.
    session_.state().paths["still"] = {{session_.state().camera}, 1};
    act(session_, {{"do", "play"}, {"name", "still"}});
    const HlodSettings& settings = session_.state().settings.hlod;
    const auto device = make_portable_device(settings.device);
    hlod::TraverseOptions options = settings.traverse;
    options.geomorph = settings.between == HlodBetween::geomorph;
    options.within = settings.between == HlodBetween::within;
    options.costs = session_.frame()->device_costs.value_or(hlod::DeviceCosts{});
    hlod::Traverser traverser(placed);
    const hlod::Frame& expected = traverser.draw_frame(View(session_.state().camera), *device, options);
    EXPECT_EQ(side().front->frame.front_hash, expected.front_hash) << name << " " << value;
    EXPECT_EQ(stats().queries, expected.stats.queries) << name << " " << value;
    hashes.insert(expected.front_hash);
  }
  EXPECT_GT(hashes.size(), 5U);  // and they matter
}

TEST_F(HlodSession, AViewThatStandsStillIsDrawnUntilItsFrontStays) {
  open();
  set("strategy", "vfc");
  set("strategy", "coh");
  EXPECT_FALSE(session_.frame()->goes_on);
  EXPECT_EQ(stats().delayed, 0U);  // which only the first frames have
  EXPECT_GT(stats().queries, 0U);
  set("settle", false);
  set("strategy", "vfc");
  const std::uint64_t number = side().front->number;
  set("strategy", "coh");
  EXPECT_EQ(side().front->number, number + 1);
  EXPECT_GT(stats().delayed, 0U);
}

// Each half is what its strategy draws alone.
TEST_F(HlodSession, TwoStrategiesBesideEachOther) {
  open();
  set("strategy", "vfc");
  const std::uint64_t alone = session_.frame()->hash;
  const std::size_t nodes = stats().drawn_nodes;
  set("strategy", "coh");
  EXPECT_LT(stats().drawn_nodes, nodes);  // houses hide houses
  set("other_strategy", "vfc");
  set("compare", true);
  ASSERT_EQ(session_.frame()->hlod_sides.size(), 2U);
  EXPECT_EQ(side(0).strategy, hlod::Strategy::coh);
  EXPECT_EQ(side(1).strategy, hlod::Strategy::vfc);
  EXPECT_EQ(side(1).front->frame.front_hash, alone);
  EXPECT_EQ(session_.figures().at("other_drawn_nodes"), static_cast<double>(nodes));
  EXPECT_GT(session_.figures().at("other_frame_ms"), 0.0);
}

// Also while what is shown of it changes.
TEST_F(HlodSession, AFrozenFrontStaysWhileTheCameraFlies) {
  open();
  set("freeze", true);
  const std::uint64_t number = side().front->number;
  act(session_, {{"do", "orbit"}, {"right", 90}, {"up", 20}});
  for (const char* by : {"level", "error", "bias", "state", "patch", "plain"}) set("hlod_color_by", by);
  for (const char* boxes : {"drawn", "asked"}) set("node_boxes", boxes);
  EXPECT_EQ(side().front->number, number);
  set("freeze", false);
  EXPECT_NE(side().front->number, number);
}

TEST_F(HlodSession, ColoursTellWhatTheyAreToTell) {
  open();
  set("hlod_tolerance", 0.5);
  const auto of_draws = [&](const auto& expected) {
    const HlodFront& front = *side().front;
    for (std::size_t i = 0; i < front.frame.draws.size(); ++i)
      EXPECT_EQ(side().colors.at(0).at(front.first_triangle[i]), expected(front.frame.draws[i])) << i;
    EXPECT_EQ(side().colors[0].size(), front.objects[0].triangles.size());
  };
  set("hlod_color_by", "level");
  of_draws([&](const hlod::DrawnNode& draw) {
    return hlod_level_color(hlod().node(draw.node).level, hlod().level_count());
  });
  set("hlod_color_by", "bias");
  of_draws([](const hlod::DrawnNode& draw) { return bias_color(draw.bias); });
  set("hlod_color_by", "state");
  of_draws([](const hlod::DrawnNode& draw) { return color_of(drawn_as(draw)); });
  // The largest error on the screen is the statistic's.
  double largest = 0.0;
  set("hlod_color_by", "error");
  of_draws([&](const hlod::DrawnNode& draw) {
    const double px = error_px(draw, session_.state().objects->at(0), View(session_.state().camera));
    largest = std::max(largest, px);
    return error_color(px);
  });
  EXPECT_DOUBLE_EQ(largest, stats().largest_sse_px);
  // As many patches as were drawn.
  set("hlod_color_by", "patch");
  const std::vector<std::uint32_t>& patches = side().front->objects[0].patches;
  EXPECT_EQ(std::set<std::uint32_t>(patches.begin(), patches.end()).size(), stats().drawn_patches);
  for (std::size_t t = 0; t < patches.size(); ++t) EXPECT_EQ(side().colors[0].at(t), patch_color(patches[t]));
  set("hlod_color_by", "plain");
  EXPECT_TRUE(side().colors.at(0).empty());
}

TEST(HlodPalette, TellsEverythingApart) {
  std::vector<glm::u8vec4> colors;
  for (std::size_t i = 0; i < drawn_as_count; ++i) colors.push_back(color_of(static_cast<DrawnAs>(i)));
  for (std::size_t i = 0; i < 4; ++i) colors.push_back(color_of(static_cast<hlod::Answer>(i)));
  colors.push_back(unasked_box_color);
  for (std::size_t a = 0; a < colors.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_GT(glm::distance(glm::vec3(colors[a]), glm::vec3(colors[b])), 30.0F) << a << " " << b;
  // Blue, magenta, red (Charalambos 2006, fig. 8).
  EXPECT_EQ(glm::u8vec3(bias_color(1.0F)).x, 0);
  EXPECT_EQ(glm::u8vec3(bias_color(1.0F)).z, 255);
  EXPECT_EQ(glm::u8vec3(bias_color(0.5F)).x, 255);
  EXPECT_EQ(glm::u8vec3(bias_color(0.5F)).z, 255);
  EXPECT_EQ(glm::u8vec3(bias_color(0.0F)).x, 255);
  EXPECT_EQ(glm::u8vec3(bias_color(0.0F)).z, 0);
}

TEST_F(HlodSession, PicksANode) {
  open();
  act(session_, {{"do", "pick"}, {"x", 0.5}, {"y", 0.8}});
  ASSERT_TRUE(session_.state().pick);
  const Pick& pick = *session_.state().pick;
  ASSERT_LT(pick.node, hlod().node_count());
  EXPECT_EQ(pick.split, no_id);
  const Box& box = hlod().node(pick.node).box;
  const glm::vec3 point(pick.point);
  EXPECT_TRUE(glm::all(glm::greaterThan(point, box.min - 0.1F)) && glm::all(glm::lessThan(point, box.max + 0.1F)));
  const auto& draws = side().front->frame.draws;
  EXPECT_TRUE(std::any_of(draws.begin(), draws.end(), [&](const auto& draw) { return draw.node == pick.node; }));
}

// A scene of meshes as one HLOD; saved, it is the scene of meshes again.
TEST_F(HlodSession, ASceneOpensAsAnHlod) {
  json scene = test::city_scene("");
  scene["objects"] = json::array(
      {{{"generator", "rough-planet"}, {"options", {{"level", 3}}}},
       {{"generator", "rough-planet"}, {"options", {{"level", 3}}}, {"position", {3, 0, 0}}, {"two_sided", true}}});
  set("open_as", "hlod");
  act(session_, {{"do", "open"}, {"file", folder_.write("planets.json", scene).string()}});
  ASSERT_EQ(session_.state().objects->size(), 1U) << last_notice();
  EXPECT_EQ(hlod().data().input_triangle_count, 2U * 8U * 64U);
  act(session_, {{"do", "place"}, {"position", {0, 5, 0}}, {"object", "planets"}});
  const auto saved = folder_.path("saved.json");
  act(session_, {{"do", "save_scene"}, {"file", saved.string()}});
  const SceneDescription again = read_scene(saved);
  ASSERT_EQ(again.objects.size(), 2U);
  EXPECT_EQ(glm::dvec3(again.objects[0].object_to_world[3]), glm::dvec3(0.0, 5.0, 0.0));
  EXPECT_EQ(glm::dvec3(again.objects[1].object_to_world[3]), glm::dvec3(3.0, 5.0, 0.0));
  EXPECT_FALSE(again.objects[0].two_sided);
  EXPECT_TRUE(again.objects[1].two_sided);
}

TEST_F(HlodSession, SavesWhereAnHlodStands) {
  open();
  act(session_, {{"do", "place"}, {"object", "city"}, {"position", {1, 2, 3}}});
  const auto saved = folder_.path("saved.json");
  act(session_, {{"do", "save_scene"}, {"file", saved.string()}});
  act(session_, {{"do", "close_all"}});
  act(session_, {{"do", "open"}, {"file", saved.string()}});
  ASSERT_EQ(session_.state().objects->size(), 1U) << last_notice();
  EXPECT_EQ(session_.state().objects->at(0).placement.position, glm::dvec3(1.0, 2.0, 3.0));
  // Nor is its file overwritten.
  EXPECT_THROW(act(session_, {{"do", "screenshot"}, {"file", file_.string()}}), Error);
}

// Each in one line that names the file.
TEST_F(HlodSession, WhatDoesNotFitIsRefused) {
  const auto expect_refused = [&](const std::filesystem::path& file, const char* why) {
    const std::size_t objects = session_.state().objects->size();
    const int errors = session_.state().errors;
    act(session_, {{"do", "open"}, {"file", file.string()}});
    EXPECT_EQ(session_.state().errors, errors + 1);
    EXPECT_EQ(session_.state().objects->size(), objects);
    EXPECT_NE(last_notice().find(file.string()), std::string::npos) << last_notice();
    EXPECT_NE(last_notice().find(why), std::string::npos) << last_notice();
    EXPECT_EQ(last_notice().find('\n'), std::string::npos);
  };
  const auto bytes = std::filesystem::file_size(file_);
  for (const auto& [name, at] : {std::pair("nodes.ohlod", std::uintmax_t{600}), std::pair("mesh.ohlod", bytes / 2)}) {
    std::filesystem::copy(file_, folder_.path(name));
    std::fstream damaged(folder_.path(name), std::ios::in | std::ios::out | std::ios::binary);
    damaged.seekg(static_cast<std::streamoff>(at));
    const int byte = damaged.get();
    damaged.seekp(static_cast<std::streamoff>(at));
    damaged.put(static_cast<char>(byte ^ 0x55));
    damaged.close();
    expect_refused(folder_.path(name), "");
  }
  std::filesystem::copy(file_, folder_.path("short.ohlod"));
  std::filesystem::resize_file(folder_.path("short.ohlod"), bytes - 100);
  expect_refused(folder_.path("short.ohlod"), "");
  open();
  const auto planet = folder_.write("planet.json", test::planet_scene(3));
  expect_refused(planet, "HLODs are open");
  act(session_, {{"do", "close_all"}});
  act(session_, {{"do", "open"}, {"file", planet.string()}});
  expect_refused(file_, "meshes are open");
}

TEST_F(HlodSession, ADeviceThatIsNotThereIsToldInOneLine) {
  open();
  session_.perform(json{{"do", "set"}, {"setting", "device"}, {"value", "gl"}});
  test::settle(session_);
  EXPECT_EQ(session_.state().notices.back().text, "device: gl: needs a window; choose software");
  EXPECT_EQ(session_.frame()->side_count(), 0U);
  set("device", "software");
  EXPECT_GT(stats().drawn_nodes, 0U);
}

// Objects that move keep what is known of their nodes: no first frame, where all that is drawn is delayed.
TEST_F(HlodSession, WhatIsKnownSurvivesAMove) {
  open();
  set("settle", false);
  act(session_, {{"do", "place"}, {"object", "city"}, {"position", {0.01, 0, 0}}});
  EXPECT_LT(stats().delayed, stats().drawn_nodes);
  EXPECT_GT(stats().queries, 0U);
}

}  // namespace
}  // namespace occlod::viewer
