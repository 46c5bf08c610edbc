// Views, placements and options at the edges of what is allowed, and beyond.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <string>

#include "occlod/base.h"
#include "occlod/device.h"
#include "papers/trial_devices.h"
#include "support/error_of.h"
#include "support/hand_made_hlod.h"
#include "support/meshes.h"
#include "support/scripted_device.h"
#include "traverse/small_scenes.h"
#include "traverse/traverse_support.h"

namespace occlod::hlod {
namespace {

using occlod::test::error_of;
using namespace test;

// What stands still comes to rest: the same front from the third frame on, nothing refined after it was drawn. `coh`
// takes up to two frames a level: in one a node is asked about, in the next it stands for its children. By the place in
// the queue alone what stands still may be predicted wrongly for ever: `simp` comes to rest where whatever is visible
// counts in full. So does `sw_b`: with a bias, what is refined decides what is seen of the rest, and in one of a
// hundred views two fronts take turns (in one of six hundred with `coh`).
TEST(StandingStill, TheFrontIsTheSameFromTheThirdFrameOn) {
  for (const Grouping grouping : {Grouping::nested, Grouping::shifted})
    for (const Hlod* hlod : {&city(grouping), &planet(grouping)}) {
      const PlacedHlod placed{hlod};
      for (const TrialStrategy strategy : asking_strategies) {
        const std::size_t third = 2;
        const std::size_t at_rest = strategy == TrialStrategy::coh ? std::max(third, 2 * hlod->level_count()) : third;
        TrialOptions options = with(strategy, 2.0);
        options.biased = strategy != TrialStrategy::simp && strategy != TrialStrategy::sw_b;
        SoftwareDevice device;
        TrialTraverser traverser({&placed, 1});
        std::mt19937_64 random(3);
        for (int view = 0; view < 12; ++view) {
          const View place(view % 2 == 0 ? random_camera(hlod->data().box, random) : walk(hlod->data().box, view, 12));
          std::uint64_t front = 0;
          for (std::size_t i = 0; i < at_rest + 6; ++i) {
            const Frame& frame = traverser.draw_frame(place, device, options);
            if (i == at_rest) front = frame.front_hash;
            if (i < at_rest) continue;
            EXPECT_EQ(frame.front_hash, front) << static_cast<int>(strategy) << " view " << view << " frame " << i;
            EXPECT_EQ(frame.stats.rarn, 0U) << static_cast<int>(strategy) << " view " << view << " frame " << i;
            EXPECT_EQ(frame.stats.blocked, 0U);
          }
        }
      }
    }
}

// After a teleport the next frame is right: without a bias it shows all that vfc does.
TEST(Teleports, TheNextFrameShowsEverything) {
  const Hlod& hlod = city(Grouping::shifted);
  const PlacedHlod placed{&hlod};
  const Camera near = walk(hlod.data().box, 0, 10);
  Camera far = near;
  far.eye = near.target + glm::dvec3(0.0, -40.0, 20.0);
  for (const TrialStrategy strategy : asking_strategies) {
    SoftwareDevice device, truth;
    TrialTraverser traverser({&placed, 1}), all({&placed, 1});
    for (int i = 0; i < 9; ++i) {
      const View view(i % 4 < 2 ? near : far);
      TrialOptions options = with(strategy, 1.0);
      options.biased = false;
      const Frame& frame = traverser.draw_frame(view, device, options);
      EXPECT_EQ(frame.stats.rarn, 0U);
      options.strategy = TrialStrategy::vfc;
      all.draw_frame(view, truth, options);
      EXPECT_EQ(device.depth().nearness, truth.depth().nearness);
    }
  }
}

// 0: level 0 only, even where coarser nodes have no error at all. Huge: the roots.
TEST(Tolerance, ZeroIsTheInputAndHugeTheRoots) {
  const Hlod flat = small_hlod(occlod::test::grid(40, 40), Grouping::shifted);
  ASSERT_GT(flat.level_count(), 2U);
  const PlacedHlod placed{&flat};
  Camera camera;
  camera.eye = {0.5, 0.5, 2.0};
  camera.target = {0.5, 0.5, 0.0};
  for (const TrialStrategy strategy : asking_strategies) {
    SoftwareDevice device;
    TrialTraverser traverser({&placed, 1});
    for (int i = 0; i < 3; ++i) {
      const FrameStats& finest = traverser.draw_frame(View(camera), device, with(strategy, 0.0)).stats;
      EXPECT_EQ(finest.drawn_triangles, flat.data().input_triangle_count);
      EXPECT_EQ(finest.rarn, 0U);
    }
    // Coherent fronts move up by a level a frame at least.
    for (std::size_t i = 0; i < flat.level_count(); ++i)
      traverser.draw_frame(View(camera), device, with(strategy, 1e300));
    const FrameStats& coarsest = traverser.draw_frame(View(camera), device, with(strategy, 1e300)).stats;
    EXPECT_EQ(coarsest.drawn_nodes, flat.data().roots.size());
  }
}

TEST(BiasAtItsEnds, IsTraversed) {
  const Hlod& hlod = city(Grouping::shifted);
  const PlacedHlod placed{&hlod};
  std::size_t drawn_by[2][2] = {};
  for (const TrialStrategy strategy : asking_strategies)
    for (const double s : {0.0, 1.0})
      for (const double t : {0.0, 1.0}) {
        SoftwareDevice device;
        TrialTraverser traverser({&placed, 1});
        for (int i = 0; i < 12; ++i) {
          TrialOptions options = with(strategy, 1.0);
          options.bias = {s, t};
          const FrameStats& stats = traverser.draw_frame(View(walk(hlod.data().box, i, 100)), device, options).stats;
          EXPECT_GT(stats.drawn_nodes, 0U);
          if (strategy == TrialStrategy::sw_b) drawn_by[s > 0.0 ? 1 : 0][t > 0.0 ? 1 : 0] += stats.drawn_triangles;
        }
      }
  EXPECT_EQ(drawn_by[0][0], drawn_by[0][1]);  // mu itself, whatever t
  EXPECT_GT(drawn_by[1][0], drawn_by[0][0]);  // 1 - (1 - mu)^2 counts more,
  EXPECT_LT(drawn_by[1][1], drawn_by[0][0]);  // mu^2 less
}

// A field of view of a millionth of a degree, a single pixel, the largest image, a near plane beyond everything.
TEST(Frustum, OfAnySizeIsTraversed) {
  const Hlod& hlod = planet(Grouping::shifted);
  const PlacedHlod placed{&hlod};
  std::vector<Camera> cameras;
  std::mt19937_64 random(41);
  for (int i = 0; i < 4; ++i) {
    Camera camera = random_camera(hlod.data().box, random);
    camera.fov_y_deg = 1e-6;
    cameras.push_back(camera);
    camera.fov_y_deg = 60.0;
    camera.width = camera.height = 1;
    cameras.push_back(camera);
    camera.width = 4096;
    camera.height = 1;
    cameras.push_back(camera);
    camera.width = camera.height = 64;
    camera.near = 1e5;
    camera.far = 1e6;
    cameras.push_back(camera);
    camera.near = 1.0;  // through the middle of nearly everything
    camera.eye = camera.target + glm::dvec3(0.0, 0.0, 1.0);
    camera.up = {0.0, 1.0, 0.0};
    cameras.push_back(camera);
  }
  for (const TrialStrategy strategy : asking_strategies) {
    SoftwareDevice device, truth;
    TrialTraverser traverser({&placed, 1}), all({&placed, 1});
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      TrialOptions options = with(strategy, 1.0);
      options.biased = false;
      const View view(cameras[i]);
      const FrameStats& stats = traverser.draw_frame(view, device, options).stats;
      EXPECT_EQ(stats.visits > 0, cameras[i].near < 1e4) << i;
      EXPECT_TRUE(std::isfinite(stats.largest_sse_px));
      options.strategy = TrialStrategy::vfc;
      all.draw_frame(view, truth, options);
      EXPECT_EQ(device.depth().nearness, truth.depth().nearness) << i;
    }
  }
}

// With the eye in its box, on its face or so near that the near plane cuts it, a node is visible without a question.
// Its error is that at the near plane: finite.
TEST(Eye, OnAFaceOfABox) {
  const Hlod& hlod = planet(Grouping::shifted);
  const PlacedHlod placed{&hlod};
  std::mt19937_64 random(43);
  for (const TrialStrategy strategy : asking_strategies) {
    occlod::test::ScriptedDevice device;
    occlod::test::LoggedDevice logged(device);
    TrialTraverser traverser({&placed, 1});
    std::size_t drawn = 0;
    for (int i = 0; i < 20; ++i) {
      const auto n = static_cast<NodeId>(random() % hlod.node_count());
      const Box& box = hlod.node(n).box;
      Camera camera;
      camera.eye = (glm::dvec3(box.min) + glm::dvec3(box.max)) / 2.0;
      camera.eye[i % 3] = i % 2 == 0 ? static_cast<double>(box.max[i % 3]) : static_cast<double>(box.min[i % 3]);
      camera.target = camera.eye + glm::dvec3(0.3, 0.4, 0.5);
      camera.near = 1e-3;
      const FrameStats& stats = traverser.draw_frame(View(camera), logged, with(strategy, 4.0)).stats;
      drawn += stats.drawn_nodes;
      EXPECT_TRUE(std::isfinite(stats.largest_sse_px));
      EXPECT_EQ((", " + logged.log() + ",").find(", ask " + std::to_string(n) + ","), std::string::npos) << n;
    }
    EXPECT_GT(drawn, 0U);
  }
}

// Mirrored and turned the other way, everything is as before, pixels too but for rounding: the same nodes are drawn.
TEST(Placements, MirroredIsTheSameFront) {
  const Hlod& hlod = planet(Grouping::shifted);
  const PlacedHlod placed{&hlod};
  const PlacedHlod mirrored{&hlod, glm::scale(glm::dmat4(1.0), glm::dvec3(-1.0, 1.0, 1.0))};
  std::mt19937_64 random(47);
  for (const TrialStrategy strategy : {TrialStrategy::vfc, TrialStrategy::sw, TrialStrategy::coh}) {
    SoftwareDevice one, other;
    TrialTraverser a({&placed, 1}), b({&mirrored, 1});
    for (int i = 0; i < 10; ++i) {
      Camera camera = random_camera(hlod.data().box, random);
      camera.width = 161;  // an odd number: pixels have mirror images
      TrialOptions options = with(strategy, 1.0);
      options.biased = false;
      const Frame& straight = a.draw_frame(View(camera), one, options);
      camera.eye.x = -camera.eye.x;
      camera.target.x = -camera.target.x;
      const Frame& turned = b.draw_frame(View(camera), other, options);
      EXPECT_TRUE(strategy != TrialStrategy::vfc || straight.front_hash == turned.front_hash);
      EXPECT_NEAR(static_cast<double>(straight.stats.drawn_nodes), static_cast<double>(turned.stats.drawn_nodes),
                  0.05 * static_cast<double>(straight.stats.drawn_nodes) + 1.0);
    }
  }
}

// Everything larger by a power of two is the same to the last bit: fronts, questions, answers.
TEST(Placements, PowersOfTwoAreTheSameFront) {
  const Hlod& hlod = city(Grouping::shifted);
  for (const TrialStrategy strategy : {TrialStrategy::sw_b, TrialStrategy::simp, TrialStrategy::coh})
    for (const bool parallel : {false, true}) {
      std::vector<std::uint64_t> fronts;
      for (const int exponent : {0, -20, 7, 30}) {
        const double scale = std::exp2(exponent);
        const PlacedHlod placed{&hlod, glm::scale(glm::dmat4(1.0), glm::dvec3(scale))};
        SoftwareDevice device;
        TrialTraverser traverser({&placed, 1});
        for (std::size_t i = 0; i < 8; ++i) {
          Camera camera = walk(hlod.data().box, static_cast<int>(i), 100);
          if (parallel) camera.orthographic_height = 2.0 * scale;
          camera.eye *= scale;
          camera.target *= scale;
          camera.near *= scale;
          camera.far *= scale;
          const Frame& frame = traverser.draw_frame(View(camera), device, with(strategy, 1.0));
          if (exponent == 0)
            fronts.push_back(frame.front_hash);
          else
            EXPECT_EQ(frame.front_hash, fronts[i]) << exponent << " frame " << i;
        }
      }
    }
}

// A billion units from the origin, with the camera: what vfc shows is shown.
TEST(Placements, FarFromTheOrigin) {
  const Hlod& hlod = city(Grouping::shifted);
  const glm::dvec3 away(1e9, -1e9, 1e9);
  const PlacedHlod placed{&hlod, glm::translate(glm::dmat4(1.0), away)};
  for (const TrialStrategy strategy : asking_strategies) {
    SoftwareDevice device, truth;
    TrialTraverser traverser({&placed, 1}), all({&placed, 1});
    for (int i = 0; i < 6; ++i) {
      Camera camera = walk(hlod.data().box, i, 100);
      camera.eye += away;
      camera.target += away;
      TrialOptions options = with(strategy, 1.0);
      options.biased = false;
      const Frame& frame = traverser.draw_frame(View(camera), device, options);
      EXPECT_GT(frame.stats.drawn_nodes, 0U);
      options.strategy = TrialStrategy::vfc;
      EXPECT_GT(all.draw_frame(View(camera), truth, options).stats.drawn_nodes, frame.stats.drawn_nodes);
      EXPECT_EQ(device.depth().nearness, truth.depth().nearness);
    }
  }
}

TEST(BadInput, IsRefusedInOneLine) {
  const Hlod panel = occlod::test::one_panel({0.0F, 0.0F, 0.0F}, {1.0F, 1.0F});
  const Hlod nothing;
  const auto make = [](const PlacedHlod& placed) { TrialTraverser traverser({&placed, 1}); };
  EXPECT_EQ(error_of([] { TrialTraverser traverser(std::span<const PlacedHlod>{}); }),
            "traverser: has no objects; give at least one HLOD");
  EXPECT_EQ(error_of([&] { make({}); }), "traverser: object 0: has no HLOD; build one first");
  EXPECT_EQ(error_of([&] { make({&nothing}); }),
            "traverser: object 0: has an HLOD without nodes; build it from a mesh with triangles");
  EXPECT_NE(error_of([&] { make({&panel, glm::dmat4(0.0)}); }).find("transform"), std::string::npos);
  const PlacedHlod placed{&panel};
  TrialTraverser traverser({&placed, 1});
  EXPECT_EQ(error_of([&] { traverser.set_transform(1, glm::dmat4(1.0)); }),
            "traverser: object 1: is not there; there are 1, counted from 0");
  EXPECT_NE(error_of([&] { traverser.set_transform(0, glm::dmat4(std::nan(""))); }).find("transform"),
            std::string::npos);
  occlod::test::ScriptedDevice device;
  const auto draw = [&](const std::function<void(TrialOptions&)>& change) {
    TrialOptions options;
    change(options);
    return error_of([&] { traverser.draw_frame(View(Camera()), device, options); });
  };
  for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_NE(draw([&](TrialOptions& o) { o.tolerance_px = bad; }).find("tolerance_px"), std::string::npos);
    EXPECT_NE(draw([&](TrialOptions& o) { o.bias.s = bad; }).find("bias.s"), std::string::npos);
    EXPECT_NE(draw([&](TrialOptions& o) { o.bias.t = bad; }).find("bias.t"), std::string::npos);
  }
  EXPECT_NE(draw([&](TrialOptions& o) { o.strategy = TrialStrategy::ideal; }).find("oracle: is missing"),
            std::string::npos);
  EXPECT_NE(draw([&](TrialOptions& o) {
              o.strategy = TrialStrategy::ideal;
              o.oracle = &device;
            }).find("oracle: is the device"),
            std::string::npos);
  EXPECT_EQ(draw([](TrialOptions&) {}), "");
}

// Answers so many questions more.
class FailingDevice : public occlod::test::ScriptedDevice {
 public:
  [[nodiscard]] std::span<const std::uint32_t> wait(QueryId query) override {
    if (answers-- == 0) throw Error({"device", "", "has failed", ""});
    return ScriptedDevice::wait(query);
  }
  std::size_t answers = 1000;
};

TEST(Failure, TheNextFrameIsLikeTheFirst) {
  const Hlod rows = occlod::test::two_rows();
  const PlacedHlod placed{&rows};
  FailingDevice device;
  occlod::test::LoggedDevice logged(device);
  TrialTraverser traverser({&placed, 1});
  Camera camera;
  camera.eye = {-2.0, 0.0, 10.0};
  camera.target = {-2.0, 0.0, 0.0};
  const auto log = [&](TrialStrategy strategy) {
    traverser.draw_frame(View(camera), logged, with(strategy, 1.0));
    return logged.log();
  };
  const auto log_of_first = [&](TrialStrategy strategy) {
    occlod::test::ScriptedDevice untouched;
    occlod::test::LoggedDevice fresh_log(untouched);
    TrialTraverser fresh({&placed, 1});
    fresh.draw_frame(View(camera), fresh_log, with(strategy, 1.0));
    return fresh_log.log();
  };
  const std::string first = log(TrialStrategy::coh), second = log(TrialStrategy::coh);
  EXPECT_NE(first, second);
  EXPECT_EQ(log(TrialStrategy::coh), second);
  device.answers = 2;  // nodes 3 and 4 have been seen
  EXPECT_EQ(error_of([&] { log(TrialStrategy::coh); }), "device: has failed");
  device.answers = 1000;
  EXPECT_EQ(log(TrialStrategy::coh), first);
  EXPECT_EQ(log(TrialStrategy::coh), second);
  traverser.reset();
  EXPECT_EQ(log(TrialStrategy::coh), first);
  // A strategy begins with nothing that another has left.
  EXPECT_EQ(log(TrialStrategy::simp), log_of_first(TrialStrategy::simp));
  EXPECT_EQ(log(TrialStrategy::coh), first);
  // What is refused changes nothing.
  EXPECT_NE(error_of([&] { traverser.draw_frame(View(camera), logged, with(TrialStrategy::coh, -1.0)); }), "");
  EXPECT_EQ(log(TrialStrategy::coh), second);
}

// Two objects at one place: the first goes first, and of its nodes the coarser.
TEST(Ties, GoByObjectThenByNode) {
  const Hlod panel = occlod::test::one_panel({-1.0F, -1.0F, 0.0F}, {2.0F, 2.0F});
  const PlacedHlod placed[] = {{&panel}, {&panel}, {&panel}};
  occlod::test::ScriptedDevice device;
  occlod::test::LoggedDevice logged(device);
  TrialTraverser traverser(placed);
  traverser.draw_frame(View(Camera()), logged, with(TrialStrategy::sw, 1.0));
  EXPECT_EQ(occlod::test::commands_of(logged.log()), "ask 0, draw 0, ask 1/0, draw 1/0, ask 2/0, draw 2/0");
}

}  // namespace
}  // namespace occlod::hlod
