// What every device answers. Geometry leaves one answer to each case.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <limits>
#include <numeric>
#include <random>
#include <set>

#include "device/small_scenes.h"
#include "device/tested_devices.h"
#include "occlod/build_hlod.h"
#include "occlod/generate.h"
#include "occlod/item_buffer.h"
#include "support/meshes.h"

namespace occlod::hlod {
namespace {

using namespace test;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

class EachDevice : public testing::TestWithParam<TestedDevice> {
 protected:
  void SetUp() override {
    std::string why;
    device_ = GetParam().make(why);
    if (!device_) GTEST_SKIP() << "SKIPPED: " << GetParam().label << ": " << why;
  }
  // One object, nothing drawn.
  void begin(const Hlod& hlod, const glm::dmat4& to_world = glm::dmat4(1.0)) {
    const PlacedHlod placed{&hlod, to_world};
    device_->begin_frame(View(camera_), {&placed, 1});
  }
  // With the wall drawn.
  void begin_behind_wall() {
    begin(wall());
    draw_finest(*device_, 0, wall());
  }
  [[nodiscard]] std::uint32_t count(const Box& box, std::uint32_t object = 0) const {
    return count_of(*device_, {object, box});
  }
  [[nodiscard]] std::uint32_t pixels() const {
    return static_cast<std::uint32_t>(camera_.width) * static_cast<std::uint32_t>(camera_.height);
  }

  Camera camera_ = small_camera();
  std::unique_ptr<RenderDevice> device_;
};

INSTANTIATE_TEST_SUITE_P(Devices, EachDevice, testing::ValuesIn(tested_devices()),
                         [](const auto& param) { return param.param.label; });

// A square of 20 pixels a side, seen from the front: grown by 3/4 pixel to each side, and nearer by as much.
TEST_P(EachDevice, CountsThePixelsOfAFront) {
  begin(wall());
  const auto half = static_cast<float>(10.0 * pixel_at_wall);
  const double side = std::sqrt(count({{-half, -half, -0.5F}, {half, half, 0.0F}}));
  EXPECT_GE(side, 20.0);
  EXPECT_LE(side, 23.0);
}

TEST_P(EachDevice, ABoxIsHiddenByWhatIsDrawnBeforeItIsAsked) {
  const Box behind = cube({0.2F, 0.1F, -1.0F}, 0.2F), before = cube({0.2F, 0.1F, 1.0F}, 0.2F);
  begin(wall());
  const std::uint32_t on_empty = count(behind);
  EXPECT_GT(on_empty, 10U);
  draw_finest(*device_, 0, wall());
  EXPECT_EQ(count(behind), 0U);
  EXPECT_GT(count(before), on_empty);
  // Asked before the next draw, answered after it.
  begin(wall());
  const BoxRef box{0, behind};
  const QueryId query = device_->ask({&box, 1});
  draw_finest(*device_, 0, wall());
  EXPECT_EQ(device_->wait(query)[0], on_empty);
  // An empty image again.
  begin(wall());
  EXPECT_EQ(count(behind), on_empty);
}

// Half of it is seen beside the wall, whose border is at x = 1.
TEST_P(EachDevice, CountsWhatIsSeenBesideAnOccluder) {
  const Box box{{0.5F, -0.5F, -0.3F}, {1.5F, 0.5F, -0.29F}};
  begin(wall());
  const std::uint32_t all = count(box);
  draw_finest(*device_, 0, wall());
  const std::uint32_t seen = count(box);
  EXPECT_GT(seen, all / 4);
  EXPECT_LT(seen, all * 3 / 4);
}

// Without a volume they are points, lines and sheets, and those are somewhere all the same: before the wall or on it,
// which is visible, or behind it.
TEST_P(EachDevice, FlatAndPointSizedBoxesAreWhereTheyAre) {
  begin_behind_wall();
  for (const float z : {0.5F, 0.0F, -0.5F}) {
    const glm::vec3 p(0.2F, 0.1F, z);
    const bool visible = z >= 0.0F;
    EXPECT_EQ(count({p, p}) > 0, visible) << z;
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == 2 && z != 0.5F) continue;  // lines along z go through the wall
      glm::vec3 along(0.0F), across(0.1F);
      along[axis] = 0.1F;
      across[axis] = 0.0F;
      EXPECT_EQ(count({p - along, p + along}) > 0, visible) << z << " axis " << axis;
      if (axis == 2) {
        EXPECT_EQ(count({p - across, p + across}) > 0, visible) << z;
      }
    }
  }
  // Smaller than a pixel, wherever it lies in it.
  for (int i = 0; i < 50; ++i) {
    const glm::vec3 p(0.013F * static_cast<float>(i), 0.007F * static_cast<float>(i), 0.01F);
    EXPECT_GT(count(cube(p, 1e-6F)), 0U) << i;
    EXPECT_EQ(count(cube(p - glm::vec3(0, 0, 0.5F), 1e-6F)), 0U) << i;
  }
}

// Each would be behind the wall if the bad number were a good one. Where it is nobody knows.
TEST_P(EachDevice, BoxesThatAreNotFiniteCountTheWholeImage) {
  begin_behind_wall();
  for (const float bad : {nan, infinity, -infinity})
    for (int axis = 0; axis < 3; ++axis)
      for (const bool low : {false, true}) {
        Box box = cube({0.0F, 0.0F, -0.5F}, 0.1F);
        (low ? box.min : box.max)[axis] = bad;
        EXPECT_EQ(count(box), pixels()) << bad << " axis " << axis;
      }
  EXPECT_EQ(count({{0.1F, 0.1F, -0.4F}, {-0.1F, -0.1F, -0.6F}}), pixels());
  const float huge = std::numeric_limits<float>::max();
  EXPECT_EQ(count({glm::vec3(-huge), glm::vec3(huge)}), pixels());
}

TEST_P(EachDevice, BoxesThroughTheNearPlaneCountTheWholeImage) {
  begin_behind_wall();
  EXPECT_EQ(count(cube({0.0F, 0.0F, 3.0F}, 0.2F)), pixels());
  EXPECT_EQ(count(cube({0.0F, 0.0F, 3.0F}, 50.0F)), pixels());
  EXPECT_EQ(count({{-0.01F, -0.01F, -0.5F}, {0.01F, 0.01F, 2.95F}}), pixels());
  EXPECT_EQ(count({{-0.01F, -0.01F, -0.5F}, {0.01F, 0.01F, 5.0F}}), pixels());
  // The eye in a face.
  EXPECT_EQ(count({{-1.0F, -1.0F, 3.0F}, {1.0F, 1.0F, 4.0F}}), pixels());
  // All of it nearer than the near plane, or behind.
  EXPECT_EQ(count(cube({0.0F, 0.0F, 2.95F}, 0.01F)), 0U);
  EXPECT_EQ(count(cube({0.0F, 0.0F, 3.0F}, 0.05F)), 0U);
  EXPECT_EQ(count(cube({0.0F, 0.0F, 5.0F}, 1.0F)), 0U);
}

TEST_P(EachDevice, BoxesBesideTheImageCountNothing) {
  begin(wall());
  for (const glm::vec3 side : {glm::vec3(1, 0, 0), {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}}) {
    EXPECT_EQ(count(cube(10.0F * side, 1.0F)), 0U);
    EXPECT_EQ(count(cube(1e6F * side, 1.0F)), 0U);
  }
}

// A sheet behind the wall is hidden however large it is, until it sticks out: counted up to 65,536 pixels
// from the middle of the image, taken for visible beyond.
TEST_P(EachDevice, HugeBoxesAreCountedAsFarAsTheyCanBe) {
  camera_.fov_y_deg = 30.0;  // the wall, two units high, fills the image: 1.6 are seen, 1.61 * 4 / 3 = 2.14 wide
  camera_.width = 48;
  begin_behind_wall();
  EXPECT_EQ(count({{-3.0F, -3.0F, -1.1F}, {3.0F, 3.0F, -1.0F}}), 0U);
  EXPECT_EQ(count({{-3.0F, -3.0F, 0.9F}, {3.0F, 3.0F, 1.0F}}), pixels());
  EXPECT_EQ(count({{-1000.0F, -1000.0F, -1.1F}, {1000.0F, 1000.0F, -1.0F}}), 0U);
  EXPECT_EQ(count({{-1000.0F, -1000.0F, 0.9F}, {1000.0F, 1000.0F, 1.0F}}), pixels());
  EXPECT_EQ(count({{-1e6F, -1e6F, -1.1F}, {1e6F, 1e6F, -1.0F}}), pixels());
  EXPECT_EQ(count({{-3.0F, -0.1F, -1.1F}, {3.0F, 0.1F, -1.0F}}), 0U);
}

TEST_P(EachDevice, SeveralBoxesAreOneSum) {
  begin_behind_wall();
  const BoxRef left{0, cube({-0.3F, 0.0F, 0.2F}, 0.1F)}, right{0, cube({0.3F, 0.0F, 0.2F}, 0.1F)};
  const BoxRef hidden{0, cube({0.0F, 0.0F, -0.5F}, 0.2F)}, hidden_too{0, cube({0.3F, 0.2F, -0.5F}, 0.2F)};
  const auto count_all = [&](std::initializer_list<BoxRef> boxes) {
    return device_->wait(device_->ask({boxes.begin(), boxes.size()}))[0];
  };
  const std::uint32_t one = count_all({left}), other = count_all({right});
  EXPECT_LE(count_all({left, right}), one + other);
  EXPECT_GE(count_all({left, right}) + (GetParam().multisampled ? 1U : 0U), one + other);
  EXPECT_EQ(count_all({hidden, left, hidden_too}), one);
  EXPECT_EQ(count_all({hidden, hidden_too}), 0U);
  // Never more than the image has.
  const BoxRef unknown{0, cube({0.0F, 0.0F, 3.0F}, 0.1F)};
  EXPECT_EQ(count_all({unknown, unknown, left}), pixels());
}

TEST_P(EachDevice, AskingEachIsAskingOneByOne) {
  const Hlod& hlod = planet();
  begin(hlod);
  draw_finest(*device_, 0, hlod);
  std::vector<BoxRef> boxes;
  for (NodeId n = 0; n < hlod.node_count(); ++n) boxes.push_back({0, hlod.node(n).box});
  boxes.push_back({0, cube({0.0F, 0.0F, 3.0F}, 0.1F)});
  boxes.push_back({0, {glm::vec3(nan), glm::vec3(1.0F)}});
  boxes.push_back({0, cube({50.0F, 0.0F, 0.0F}, 0.1F)});
  std::vector<std::uint32_t> single;
  single.reserve(boxes.size());
  for (const BoxRef& box : boxes) single.push_back(count_of(*device_, box));
  const auto each = device_->wait(device_->ask_each(boxes));
  EXPECT_EQ(std::vector<std::uint32_t>(each.begin(), each.end()), single);
  EXPECT_GT(std::count(single.begin(), single.end(), 0U), 5);
  EXPECT_EQ(device_->wait(device_->ask_each({})).size(), 0U);
}

TEST_P(EachDevice, AnswersStayUntilTheyAreRead) {
  begin(wall());
  const Box box = cube({0.2F, 0.1F, -1.0F}, 0.2F);
  const BoxRef ref{0, box};
  const std::uint32_t expected = count(box);
  std::vector<QueryId> queries;
  for (int i = 0; i < 300; ++i) queries.push_back(device_->ask({&ref, 1}));
  for (auto query = queries.rbegin(); query != queries.rend(); ++query) {
    EXPECT_EQ(device_->wait(*query)[0], expected);
    EXPECT_TRUE(device_->available(*query));
    EXPECT_EQ(device_->wait(*query)[0], expected);  // twice is no different
  }
  // Unread answers are dropped with the frame.
  (void)device_->ask({&ref, 1});
  device_->end_frame();
  begin(wall());
  EXPECT_EQ(count(box), expected);
}

TEST_P(EachDevice, TimesAreThoseOfAFrame) {
  begin_behind_wall();
  (void)count(cube({0.2F, 0.1F, -1.0F}, 0.2F));
  device_->visit(3);
  const FrameTimes times = device_->end_frame();
  EXPECT_GE(times.frame_ms, 0.0);
  EXPECT_LE(times.cpu_ms, times.frame_ms * 1.001);
  EXPECT_LE(times.gpu_ms, times.frame_ms * 1.001);
  EXPECT_GE(times.stall_ms, 0.0);
  EXPECT_LE(times.stall_ms, times.cpu_ms * 1.001);
  EXPECT_GE(times.starve_ms, 0.0);
}

// Placed otherwise, the same is before and behind the same.
TEST_P(EachDevice, PlacementsDoNotMatter) {
  struct Case {
    const char* name;
    glm::dmat4 to_world;
    glm::dvec3 moved;  // the camera
  };
  const glm::dmat4 one(1.0);
  const std::vector<Case> cases{
      {"mirrored", glm::scale(one, {-1, 1, 1}), {}},
      {"upside down", glm::rotate(one, glm::radians(180.0), {0, 0, 1}), {}},
      {"large", glm::scale(one, glm::dvec3(1.0)) * glm::scale(one, {1.5, 1.5, 1.0}), {}},
      {"far from the origin", glm::translate(one, {1e9, -1e9, 1e9}), {1e9, -1e9, 1e9}},
  };
  for (const bool parallel : {false, true})
    for (const Case& row : cases) {
      SCOPED_TRACE(std::string(row.name) + (parallel ? ", parallel" : ""));
      camera_ = small_camera();
      camera_.eye += row.moved;
      camera_.target += row.moved;
      if (parallel) camera_.orthographic_height = 2.5;
      begin(wall(), row.to_world);
      draw_finest(*device_, 0, wall());
      for (const float x : {-0.4F, 0.0F, 0.4F}) {
        EXPECT_EQ(count(cube({x, 0.2F, -0.5F}, 0.2F)), 0U) << x;
        EXPECT_GT(count(cube({x, 0.2F, 0.5F}, 0.2F)), 10U) << x;
        EXPECT_GT(count({{x - 0.1F, -0.1F, -0.1F}, {x + 0.1F, 0.1F, 0.0F}}), 0U) << x;
      }
    }
}

// Two objects, one of them seen from behind: both sides are drawn.
TEST_P(EachDevice, BothSidesHide) {
  const glm::dmat4 turned = glm::rotate(glm::dmat4(1.0), glm::radians(180.0), {0, 1, 0});
  for (const bool two_sided : {false, true}) {
    const std::vector<PlacedHlod> placed{{&wall(), turned, two_sided}, {&planet(), glm::dmat4(1.0), two_sided}};
    device_->begin_frame(View(camera_), placed);
    draw_finest(*device_, 0, wall());
    EXPECT_EQ(count(cube({0.0F, 0.0F, -0.5F}, 0.1F), 1), 0U);
    EXPECT_EQ(count(cube({0.0F, 0.0F, 0.5F}, 0.1F), 0), 0U);  // the same place in the space of the turned wall
    EXPECT_GT(count(cube({0.0F, 0.0F, 0.5F}, 0.1F), 1), 0U);
  }
}

TEST_P(EachDevice, ImagesOfEverySize) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 7}, {2, 1}, {1024, 3}, {16384, 2}, {3, 16384}, {1025, 769}}) {
    SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height));
    camera_ = small_camera();
    camera_.width = width;
    camera_.height = height;
    camera_.orthographic_height = 2.0 * std::min(1.0, static_cast<double>(height) / width);
    begin(wall());
    // A pixel is at most two units wide, which is how far boxes are grown in depth too.
    const Box behind = cube({0.0F, 0.0F, -5.0F}, 0.3F), before = cube({0.0F, 0.0F, 1.0F}, 0.3F);
    const std::uint32_t visible = count(behind);
    EXPECT_GT(visible, 0U);
    EXPECT_LE(visible, pixels());
    EXPECT_GT(count({{-0.9F, -0.9F, 0.5F}, {0.9F, 0.9F, 0.6F}}), pixels() / 4);
    draw_finest(*device_, 0, wall());
    EXPECT_EQ(count(behind), 0U);
    EXPECT_GT(count(before), 0U);
    EXPECT_EQ(count(cube({0.0F, 0.0F, 3.0F}, 0.3F)), pixels());
  }
}

// All splits of a node give the triangles of its children, and none give its own; what they hide is the same.
TEST_P(EachDevice, CutsWithinNodesHideAsTheirTrianglesDo) {
  const Hlod hlod =
      build_hlod(generate("rough-planet", {{"level", 5}}), {.node_triangles = 128, .within = Within::splits});
  ASSERT_EQ(hlod.data().roots.size(), 1U);
  const std::uint32_t all = hlod.data().within[0].splits;
  const auto counts_behind = [&](const auto& draw) {
    begin(hlod);
    draw();
    std::vector<BoxRef> boxes;
    for (NodeId n = 0; n < hlod.node_count(); ++n) boxes.push_back({0, hlod.node(n).box});
    const auto counts = device_->wait(device_->ask_each(boxes));
    return std::vector<std::uint32_t>(counts.begin(), counts.end());
  };
  const auto draw_cut = [&](std::uint32_t splits) {
    const NodeCut cut = cut_with_splits(hlod, 0, splits);
    device_->draw({0, 0, {}, cut.indices, splits});
  };
  const auto draw_children = [&] {
    for (const NodeId child : hlod.children(0)) draw_node(*device_, 0, hlod, child);
  };
  const auto fine = counts_behind(draw_children), coarse = counts_behind([&] { draw_node(*device_, 0, hlod, 0); });
  EXPECT_NE(fine, coarse);
  EXPECT_EQ(counts_behind([&] { draw_cut(all); }), fine);
  // Few splits first, in the same frame: each draw is of the splits that it names.
  EXPECT_EQ(counts_behind([&] { draw_cut(1), draw_cut(all), draw_cut(1); }),
            counts_behind([&] { draw_cut(1), draw_children(); }));
}

// ---- Nothing visible is lost.

// Which triangles of level 0 own pixels, by our rasteriser.
std::vector<bool> visible_triangles(const View& view, const Hlod& hlod, const glm::dmat4& to_world) {
  ItemBuffer items;
  items.reset(view.width(), view.height());
  const ObjectView object(view, to_world);
  const Level& level = hlod.data().levels[0];
  std::uint32_t first = 0;
  for (NodeId n = level.first_node; n < level.first_node + level.node_count; ++n) {
    const NodeMesh mesh = hlod.mesh(n);
    std::vector<Triangle> triangles;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
      triangles.emplace_back(mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]);
    draw_items(items, mesh.positions, triangles, object.object_to_clip(), first);
    first += static_cast<std::uint32_t>(triangles.size());
  }
  return visible_items(items, first);
}

Box box_of(const NodeMesh& mesh, std::size_t triangle) {
  const std::array<glm::vec3, 3> corners{mesh.positions[mesh.indices[3 * triangle]],
                                         mesh.positions[mesh.indices[3 * triangle + 1]],
                                         mesh.positions[mesh.indices[3 * triangle + 2]]};
  return bounding_box(corners);
}

// Draws level 0 and asks about every node and every visible triangle of it, of which a part may be counted 0. Returns
// how many nodes count nothing.
std::size_t expect_nothing_lost(RenderDevice& device, const View& view, const Hlod& hlod, const glm::dmat4& to_world,
                                double lost_part) {
  const std::vector<bool> visible = visible_triangles(view, hlod, to_world);
  const PlacedHlod placed{&hlod, to_world};
  device.begin_frame(view, {&placed, 1});
  draw_finest(device, 0, hlod);
  std::vector<BoxRef> triangles;
  std::vector<std::pair<NodeId, bool>> nodes;  // and whether a triangle of it is visible
  std::size_t item = 0;
  const Level& level = hlod.data().levels[0];
  for (NodeId n = level.first_node; n < level.first_node + level.node_count; ++n) {
    const NodeMesh mesh = hlod.mesh(n);
    nodes.emplace_back(n, false);
    for (std::size_t i = 0; i < mesh.indices.size() / 3; ++i, ++item) {
      if (!visible[item]) continue;
      triangles.push_back({0, box_of(mesh, i)});
      nodes.back().second = true;
    }
  }
  const auto counts = device.wait(device.ask_each(triangles));
  EXPECT_LE(static_cast<double>(std::count(counts.begin(), counts.end(), 0U)),
            lost_part * static_cast<double>(counts.size()))
      << "of " << counts.size() << " visible triangles";
  std::size_t hidden = 0;
  for (const auto& [node, is_visible] : nodes) {
    const std::uint32_t pixels = count_of(device, {0, hlod.node(node).box});
    if (is_visible) {
      EXPECT_GT(pixels, 0U) << node;
    }
    EXPECT_LE(pixels, static_cast<std::uint32_t>(view.width() * view.height()));
    hidden += pixels == 0 ? 1 : 0;
  }
  return hidden;
}

TEST_P(EachDevice, ABoxThatHoldsAVisiblePointIsNeverCountedZero) {
  const std::vector<Hlod> hlods{
      build_hlod(generate("rough-planet", {{"level", 5}, {"amplitude", 0.2}}), {.node_triangles = 64}),
      build_hlod(generate("city", {{"blocks", 3}, {"facade_cells", 4}}), {.node_triangles = 64}),
      build_hlod(generate("pipes", {{"pipes", 10}, {"bends", 6}, {"sides", 6}}), {.node_triangles = 64})};
  std::mt19937 random(7);
  const auto number = [&] { return static_cast<double>(random() % 20'001) / 10'000.0 - 1.0; };
  std::size_t hidden = 0;
  for (std::size_t n = 0; n < 24; ++n) {
    SCOPED_TRACE(n);
    const Hlod& hlod = hlods[n % hlods.size()];
    const glm::dvec3 middle = (glm::dvec3(hlod.data().box.min) + glm::dvec3(hlod.data().box.max)) / 2.0;
    const double size = glm::length(glm::dvec3(hlod.data().box.max) - middle);
    camera_ = {.eye = middle + glm::dvec3(number(), number(), number()) * (n % 4 < 2 ? 2.0 : 0.6) * size,
               .target = middle + 0.2 * size * glm::dvec3(number(), number(), number()),
               .fov_y_deg = n % 5 == 0 ? 100.0 : 45.0,
               .width = n % 3 == 0 ? 300 : 90,
               .height = n % 3 == 0 ? 200 : 75,
               .near = 1e-3 * size,
               .far = 20.0 * size};
    if (n % 6 == 5) camera_.orthographic_height = size;
    const glm::dmat4 to_world = n % 7 == 3 ? glm::scale(glm::dmat4(1.0), {-1.0, 1.0, 1.0}) : glm::dmat4(1.0);
    hidden += expect_nothing_lost(*device_, View(camera_), hlod, to_world, GetParam().multisampled ? 0.01 : 0.0);
  }
  EXPECT_GT(hidden, 200U);  // and many boxes are hidden
}

}  // namespace
}  // namespace occlod::hlod
