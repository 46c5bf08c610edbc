// Where whatever is visible counts in full, no strategy loses anything of what `vfc` shows at the same tolerance: the
// same picture, to the bit, with fewer nodes.
#include <gtest/gtest.h>

#include <functional>
#include <glm/ext/matrix_transform.hpp>
#include <set>

#include "hlod/draw/software_drawing.h"
#include "occlod/device.h"
#include "papers/trial_devices.h"
#include "traverse/small_scenes.h"

namespace occlod::hlod {
namespace {

using namespace test;

TrialOptions unbiased(TrialStrategy strategy, double tolerance_px, RenderDevice* oracle = nullptr) {
  TrialOptions options;
  options.strategy = strategy;
  options.tolerance_px = tolerance_px;
  options.biased = false;
  options.oracle = oracle;
  options.costs = device_preset("query-dear");
  return options;
}

std::vector<float> picture(const SoftwareDevice& device) { return device.depth().nearness; }

// Two copies beside each other, one of them mirrored, turned and stretched.
std::vector<PlacedHlod> two_copies(const Hlod& hlod) {
  const Box& box = hlod.data().box;
  const glm::dvec3 size = glm::dvec3(box.max) - glm::dvec3(box.min);
  glm::dmat4 place = glm::translate(glm::dmat4(1.0), glm::dvec3(size.x * 1.2, size.y * 0.2, 0.0));
  place = glm::rotate(place, 0.7, glm::dvec3(0.0, 0.0, 1.0));
  place = glm::scale(place, glm::dvec3(1.0, -0.8, 1.3));
  return {{&hlod}, {&hlod, place}};
}

std::vector<TrialStrategy> strategies() {
  std::vector<TrialStrategy> all(asking_strategies.begin(), asking_strategies.end());
  all.insert(all.end(), later_strategies.begin(), later_strategies.end());
  all.push_back(TrialStrategy::ideal);
  return all;
}

// Wrongly hidden pixels of all strategies against vfc, along the cameras in turn. Returns how many nodes `sw` has drawn
// of those that vfc has.
template <typename Device>
double expect_nothing_lost(const std::vector<PlacedHlod>& objects, const std::vector<Camera>& cameras,
                           const std::function<std::unique_ptr<Device>()>& make,
                           const std::function<DepthBuffer(const Device&)>& depth) {
  std::vector<std::vector<float>> truth;
  std::size_t all = 0, asked = 0;
  SoftwareDevice device, oracle;
  TrialTraverser traverser(objects);
  for (const Camera& camera : cameras) {
    all += traverser.draw_frame(View(camera), device, unbiased(TrialStrategy::vfc, 2.0)).stats.drawn_nodes;
    truth.push_back(picture(device));
  }
  for (const TrialStrategy strategy : strategies()) {
    const std::unique_ptr<Device> tested = make();
    TrialTraverser one(objects);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      const FrameStats& stats = one.draw_frame(View(cameras[i]), *tested, unbiased(strategy, 2.0, &oracle)).stats;
      EXPECT_EQ(depth(*tested).nearness, truth[i]) << "strategy " << static_cast<int>(strategy) << ", frame " << i;
      EXPECT_EQ(stats.rarn, 0U);
      EXPECT_EQ(stats.blocked, 0U);
      EXPECT_LE(stats.largest_sse_px, 2.0);
      if (strategy == TrialStrategy::sw) asked += stats.drawn_nodes;
    }
  }
  return static_cast<double>(asked) / static_cast<double>(all);
}

double expect_nothing_lost(const std::vector<PlacedHlod>& objects, const std::vector<Camera>& cameras) {
  return expect_nothing_lost<SoftwareDevice>(
      objects, cameras, [] { return std::make_unique<SoftwareDevice>(); },
      [](const SoftwareDevice& device) { return device.depth(); });
}

double expect_nothing_lost_late(const std::vector<PlacedHlod>& objects, const std::vector<Camera>& cameras) {
  return expect_nothing_lost<VirtualDevice>(
      objects, cameras, [] { return std::make_unique<VirtualDevice>(device_preset("query-dear")); },
      [](const VirtualDevice& device) { return device.software().depth(); });
}

TEST(NothingVisibleIsLost, InRandomViews) {
  for (const Grouping grouping : {Grouping::nested, Grouping::shifted})
    for (const Hlod* hlod : {&city(grouping), &planet(grouping)}) {
      std::mt19937_64 random(11);
      std::vector<Camera> cameras;
      for (int i = 0; i < 20; ++i) cameras.push_back(random_camera(hlod->data().box, random));
      for (int i = 0; i < 20; i += 4) cameras[static_cast<std::size_t>(i)].orthographic_height = 1.0;
      for (int i = 1; i < 20; i += 4) cameras[static_cast<std::size_t>(i)].principal_point = {-1.0 + 0.1 * i, 0.6};
      EXPECT_LT(expect_nothing_lost({{hlod}}, cameras), 0.8);  // or nothing was hidden at all
      expect_nothing_lost(two_copies(*hlod), cameras);
    }
}

TEST(NothingVisibleIsLost, AlongAWalkWithLateAnswers) {
  for (const Grouping grouping : {Grouping::nested, Grouping::shifted}) {
    const Hlod& hlod = city(grouping);
    std::vector<Camera> cameras;
    for (int i = 0; i < 40; ++i) cameras.push_back(walk(hlod.data().box, i, 400));
    EXPECT_LT(expect_nothing_lost_late({{&hlod}}, cameras), 0.6);
  }
}

TEST(NothingVisibleIsLost, WhileObjectsMove) {
  const Hlod& hlod = city(Grouping::shifted);
  std::vector<PlacedHlod> objects = two_copies(hlod);
  SoftwareDevice device, truth, oracle;
  for (const TrialStrategy strategy : strategies()) {
    TrialTraverser traverser(objects), all(objects);
    for (int i = 0; i < 30; ++i) {
      // The second passes before the first.
      const glm::dmat4 place = glm::translate(objects[1].object_to_world, glm::dvec3(-0.1 * i, -0.05 * i, 0.0));
      traverser.set_transform(1, place);
      all.set_transform(1, place);
      const View view(walk(hlod.data().box, i, 400));
      traverser.draw_frame(view, device, unbiased(strategy, 2.0, &oracle));
      all.draw_frame(view, truth, unbiased(TrialStrategy::vfc, 2.0));
      EXPECT_EQ(picture(device), picture(truth)) << i;
    }
  }
}

// What stop-and-wait draws and is seen, every strategy draws: with late answers too.
TEST(VisibleFront, EveryStrategyDrawsASupersetOfIt) {
  const Hlod& hlod = city(Grouping::shifted);
  const PlacedHlod placed{&hlod};
  SoftwareDevice with_items(true), oracle;
  for (const TrialStrategy strategy : strategies()) {
    VirtualDevice late(device_preset("query-dear"));
    TrialTraverser waiting({&placed, 1}), tested({&placed, 1});
    for (int i = 0; i < 20; ++i) {
      const View view(walk(hlod.data().box, i, 200));
      const Frame& truth = waiting.draw_frame(view, with_items, unbiased(TrialStrategy::sw, 2.0));
      std::set<NodeId> drawn;
      for (const DrawnNode& node : tested.draw_frame(view, late, unbiased(strategy, 2.0, &oracle)).draws)
        drawn.insert(node.node);
      const std::vector<bool> visible = visible_items(with_items.items(), truth.stats.drawn_triangles);
      std::size_t item = 0, seen = 0;
      for (const DrawnNode& node : truth.draws) {
        bool is_seen = false;
        for (std::uint32_t r = 0; r < node.range_count; ++r)
          for (std::uint32_t t = 0; t < truth.ranges[node.first_range + r].index_count / 3; ++t)
            is_seen = visible[item++] || is_seen;
        seen += is_seen ? 1 : 0;
        EXPECT_TRUE(!is_seen || drawn.count(node.node) > 0) << node.node;
      }
      EXPECT_GT(seen, 0U);
    }
  }
}

}  // namespace
}  // namespace occlod::hlod
