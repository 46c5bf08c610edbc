// Traversal that refines nodes within: legal, as fine as asked for, and cheaper.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/device.h"
#include "occlod/generate.h"
#include "occlod/hlod.h"
#include "support/open_edges.h"
#include "traverse/random_device.h"
#include "traverse/small_scenes.h"

namespace occlod::hlod {
namespace {

using namespace test;

// The rough planet of the other tests, with splits.
const Hlod& refinable() {
  static const Hlod hlod =
      build_hlod(generate("rough-planet", {{"level", 5}}), {.node_triangles = 64, .within = Within::splits});
  return hlod;
}

TrialOptions options_for(TrialStrategy strategy, double tolerance_px, bool biased) {
  TrialOptions options;
  options.strategy = strategy;
  options.tolerance_px = tolerance_px;
  options.biased = biased;
  options.within = true;
  return options;
}

// What is left on top: of each node its patches or its last cut, without nodes that were refined after all.
struct Drawn {
  std::vector<bool> refined;               // by node: parent of what is drawn
  std::map<NodeId, const DrawnNode*> cut;  // the last of each node
  std::size_t open = 0;                    // edges
};

Drawn drawn_by(const Hlod& hlod, const Frame& frame) {
  Drawn drawn;
  drawn.refined.assign(hlod.node_count(), false);
  const auto for_each_patch = [&](const DrawnNode& draw, const auto& visit) {
    for (const Patch& patch : hlod.patches(draw.node))
      for (std::uint32_t r = draw.first_range; r < draw.first_range + draw.range_count; ++r) {
        const DrawRange& range = frame.ranges[r];
        if (range.first_index <= patch.first_index && patch.first_index < range.first_index + range.index_count)
          visit(patch);
      }
  };
  for (const DrawnNode& draw : frame.draws) {
    if (!draw.cut.empty()) {
      drawn.cut[draw.node] = &draw;
      for (const Patch& patch : hlod.patches(draw.node))
        if (patch.parent != no_id) drawn.refined[patch.parent] = true;
    }
    for_each_patch(draw, [&](const Patch& patch) {
      if (patch.parent != no_id) drawn.refined[patch.parent] = true;
    });
  }
  for (NodeId n = static_cast<NodeId>(hlod.node_count()); n-- > 0;)  // children first
    for (const Patch& patch : hlod.patches(n))
      if (drawn.refined[n] && patch.parent != no_id) drawn.refined[patch.parent] = true;

  occlod::test::OpenEdges edges;
  for (const DrawnNode& draw : frame.draws) {
    if (drawn.refined[draw.node]) continue;
    const NodeMesh mesh = hlod.mesh(draw.node);
    if (drawn.cut.contains(draw.node)) {
      if (drawn.cut[draw.node] != &draw) continue;
      std::vector<glm::vec3> positions(mesh.positions.begin(), mesh.positions.end());
      const auto more = hlod.within(draw.node).positions;
      positions.insert(positions.end(), more.begin(), more.end());
      edges.add(draw.cut, positions);
    }
    for_each_patch(draw, [&](const Patch& patch) {
      edges.add(mesh.indices.subspan(patch.first_index, patch.index_count), mesh.positions);
    });
  }
  drawn.open = edges.count();
  return drawn;
}

TEST(TraverseWithin, AClosedSurfaceInSightStaysClosedWhateverIsAnswered) {
  const Hlod& hlod = refinable();
  const PlacedHlod placed{&hlod};
  for (const TrialStrategy strategy : asking_strategies) {
    RandomDevice device(5, 0.0);
    TrialTraverser traverser({&placed, 1});
    std::mt19937_64 random(37);
    std::size_t cuts = 0, recuts = 0, blocked = 0;
    for (int i = 0; i < 60; ++i) {
      const double tolerance = std::exp2(uniform(random, -5.0, 1.0));
      const Frame& frame =
          traverser.draw_frame(View(from_afar(hlod, random)), device, options_for(strategy, tolerance, true));
      const Drawn drawn = drawn_by(hlod, frame);
      EXPECT_EQ(drawn.open, 0U) << static_cast<int>(strategy) << ", frame " << i;
      EXPECT_EQ(drawn.cut.size(), frame.stats.cut_nodes);
      cuts += frame.stats.cut_nodes;
      recuts += frame.stats.recut_nodes;
      blocked += frame.stats.blocked;
    }
    EXPECT_GT(cuts, 100U) << static_cast<int>(strategy);
    const bool predicts_bias = strategy == TrialStrategy::simp || strategy == TrialStrategy::coh;
    EXPECT_EQ(recuts > 0, predicts_bias) << static_cast<int>(strategy);
    EXPECT_EQ(blocked > 0, predicts_bias || strategy == TrialStrategy::sw_b) << static_cast<int>(strategy);
  }
}

// How little a node's guaranteed error becomes within is not known, so nodes are refined by their children only: the
// same front with and without, and every node on it or next to it as the bound says.
TEST(TraverseWithin, GuaranteedErrorsAreMetByChildrenOnly) {
  const Hlod& hlod = refinable();
  const PlacedHlod placed{&hlod};
  RandomDevice device(5, 0.0);
  TrialTraverser traverser({&placed, 1});
  std::mt19937_64 random(31);
  for (int i = 0; i < 30; ++i) {
    TrialOptions options = options_for(TrialStrategy::vfc, std::exp2(uniform(random, -2.0, 4.0)), false);
    options.metric = Metric::guaranteed;
    const View view(random_camera(hlod.data().box, random));
    const ScreenScale scale = screen_scale(view, ObjectView(view, placed.object_to_world));
    const Frame frame = traverser.draw_frame(view, device, options);
    EXPECT_EQ(frame.stats.cut_nodes, 0U);
    for (const DrawnNode& draw : frame.draws)
      EXPECT_LE(guaranteed_error_px(hlod.node(draw.node), scale), options.tolerance_px);
    options.within = false;
    EXPECT_EQ(traverser.draw_frame(view, device, options).front_hash, frame.front_hash);
    options.metric = Metric::box;
    EXPECT_LE(traverser.draw_frame(view, device, options).stats.drawn_triangles, frame.stats.drawn_triangles);
  }
}

TEST(TraverseWithin, EveryStrategyKeepsTheToleranceAndDrawsTheSame) {
  const Hlod& hlod = refinable();
  const PlacedHlod placed{&hlod};
  std::size_t usual = 0, within = 0, usual_nodes = 0, within_nodes = 0, cuts = 0;
  for (const TrialStrategy strategy : asking_strategies)
    for (const Metric metric : {Metric::box, Metric::sphere}) {
      RandomDevice device(5, 0.0), unasked(5, 0.0);
      TrialTraverser traverser({&placed, 1}), all({&placed, 1});
      std::mt19937_64 random(29);
      for (int i = 0; i < 30; ++i) {
        TrialOptions options = options_for(strategy, std::exp2(uniform(random, -4.0, 2.0)), false);
        options.metric = metric;
        Camera camera = random_camera(hlod.data().box, random);
        if (i % 5 == 0) camera.orthographic_height = 2.0;
        const View view(camera);
        const Frame& frame = traverser.draw_frame(view, device, options);
        EXPECT_LE(frame.stats.largest_sse_px, options.tolerance_px * (1.0 + 1e-6));
        EXPECT_EQ(frame.stats.blocked, 0U) << "without a bias cuts are always allowed";
        EXPECT_EQ(frame.stats.recut_nodes, 0U);
        cuts += frame.stats.cut_nodes;
        options.strategy = TrialStrategy::vfc;
        const Frame& truth = all.draw_frame(view, unasked, options);
        EXPECT_EQ(frame.front_hash, truth.front_hash);
        EXPECT_EQ(frame.stats.drawn_triangles, truth.stats.drawn_triangles);
        within += truth.stats.drawn_triangles;
        within_nodes += truth.stats.drawn_nodes;
        options.within = false;
        const FrameStats& plain = all.draw_frame(view, unasked, options).stats;
        usual += plain.drawn_triangles;
        usual_nodes += plain.drawn_nodes;
      }
    }
  EXPECT_GT(cuts, 1000U);
  EXPECT_LT(within, usual * 9 / 10);
  EXPECT_LT(within_nodes, usual_nodes / 2);
}

// A node may be found hidden after something below it has been seen: it counts as visible in the next frame, and in
// full.
TEST(TraverseWithin, WithoutABiasNothingIsCoarseWhateverIsHidden) {
  const Hlod& hlod = refinable();
  const PlacedHlod placed{&hlod};
  for (const TrialStrategy strategy : {TrialStrategy::coh, TrialStrategy::simp, TrialStrategy::boolean})
    for (const bool within : {true, false})
      for (const double hidden : {0.0, 0.1, 0.5}) {
        SoftwareDevice real;
        RandomDevice invented(7, hidden);
        RenderDevice& device = hidden == 0.0 ? static_cast<RenderDevice&>(real) : invented;
        TrialTraverser traverser({&placed, 1});
        std::mt19937_64 random(31);
        for (int i = 0; i < 40; ++i) {
          TrialOptions options = options_for(strategy, 0.25, false);
          options.within = within;
          const View view(i % 2 == 0 ? random_camera(hlod.data().box, random) : walk(hlod.data().box, i, 40));
          const FrameStats& stats = traverser.draw_frame(view, device, options).stats;
          EXPECT_LE(stats.largest_sse_px, options.tolerance_px * (1.0 + 1e-6)) << i << ' ' << hidden;
          EXPECT_EQ(stats.blocked, 0U) << i << ' ' << hidden;
        }
      }
}

TEST(TraverseWithin, NothingVisibleIsLost) {
  const Hlod& hlod = refinable();
  const std::vector<PlacedHlod> placed = {{&hlod}, {&hlod, glm::dmat4(glm::dmat3(0.5))}};
  for (const TrialStrategy strategy : {TrialStrategy::boolean, TrialStrategy::coh, TrialStrategy::ideal}) {
    SoftwareDevice device, truth, oracle;
    TrialTraverser traverser(placed), all(placed);
    std::size_t hidden = 0;
    for (int i = 0; i < 12; ++i) {
      const View view(walk(hlod.data().box, i, 100));
      TrialOptions options = options_for(strategy, 1.0, false);
      options.oracle = &oracle;
      const FrameStats stats = traverser.draw_frame(view, device, options).stats;
      const FrameStats all_stats = all.draw_frame(view, truth, options_for(TrialStrategy::vfc, 1.0, false)).stats;
      EXPECT_EQ(device.depth().nearness, truth.depth().nearness) << static_cast<int>(strategy) << ", frame " << i;
      EXPECT_GT(stats.cut_nodes, 0U);
      hidden += all_stats.drawn_nodes - stats.drawn_nodes;
    }
    EXPECT_GT(hidden, 0U);
  }
}

TEST(TraverseWithin, IdealDrawsWhatStopAndWaitDraws) {
  const Hlod& hlod = refinable();
  const PlacedHlod placed{&hlod};
  TrialTraverser waiting({&placed, 1}), ideal({&placed, 1});
  SoftwareDevice device, drawn_on, oracle;
  for (int i = 0; i < 10; ++i) {
    const View view(walk(hlod.data().box, i, 100));
    const Frame& asked = waiting.draw_frame(view, device, options_for(TrialStrategy::sw_b, 1.0, true));
    TrialOptions options = options_for(TrialStrategy::ideal, 1.0, true);
    options.oracle = &oracle;
    const Frame& known = ideal.draw_frame(view, drawn_on, options);
    EXPECT_EQ(known.front_hash, asked.front_hash);
    EXPECT_EQ(known.stats.cut_nodes, asked.stats.cut_nodes);
    EXPECT_GT(known.stats.cut_nodes, 0U);
    EXPECT_EQ(drawn_on.depth().nearness, device.depth().nearness);
  }
}

TEST(TraverseWithin, WithoutSplitsNothingChanges) {
  const PlacedHlod placed{&city(Grouping::shifted)};
  for (const TrialStrategy strategy : asking_strategies) {
    TrialTraverser plain({&placed, 1}), within({&placed, 1});
    SoftwareDevice device;
    for (int i = 0; i < 8; ++i) {
      const View view(walk(placed.hlod->data().box, i, 100));
      TrialOptions options = options_for(strategy, 2.0, true);
      const std::uint64_t hash = within.draw_frame(view, device, options).front_hash;
      options.within = false;
      EXPECT_EQ(plain.draw_frame(view, device, options).front_hash, hash);
    }
  }
}

TEST(TraverseWithin, AToleranceOfNothingIsTheInput) {
  const Hlod& hlod = refinable();
  const PlacedHlod placed{&hlod};
  TrialTraverser traverser({&placed, 1});
  SoftwareDevice device;
  std::mt19937_64 random(1);
  const Frame& frame =
      traverser.draw_frame(View(from_afar(hlod, random)), device, options_for(TrialStrategy::vfc, 0.0, false));
  EXPECT_EQ(frame.stats.drawn_triangles, hlod.data().input_triangle_count);
  EXPECT_EQ(frame.stats.cut_nodes, 0U);
}

TEST(TraverseWithin, DoesNotGoWithGeomorphs) {
  const PlacedHlod placed{&refinable()};
  TrialTraverser traverser({&placed, 1});
  SoftwareDevice device;
  TrialOptions options = options_for(TrialStrategy::coh, 1.0, true);
  options.geomorph = true;
  EXPECT_THROW(traverser.draw_frame(View(Camera{.eye = {0, 0, 3}}), device, options), Error);
}

}  // namespace
}  // namespace occlod::hlod
