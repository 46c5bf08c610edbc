// Whatever devices answer, and whenever: what is drawn is part of one legal front, of which validate() has shown that
// it conforms. A patch is drawn iff its parent is refined and its node is not; what is not drawn has been culled.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <set>

#include "occlod/device.h"
#include "occlod/hlod.h"
#include "traverse/front_checks.h"
#include "traverse/random_device.h"
#include "traverse/small_scenes.h"

namespace occlod::hlod {
namespace {

using namespace test;

TEST(LegalFronts, WhateverIsAnswered) {
  for (const Grouping grouping : {Grouping::nested, Grouping::shifted})
    for (const Hlod* hlod : {&city(grouping), &planet(grouping)}) {
      EXPECT_EQ(validate(*hlod), std::vector<std::string>());
      const PlacedHlod placed{hlod};
      for (const TrialStrategy strategy : asking_strategies)
        for (const double hidden : {0.0, 0.2, 0.5}) {
          RandomDevice device(17, hidden);
          TrialTraverser traverser({&placed, 1});
          std::mt19937_64 random(23);
          std::size_t rarn = 0, blocked = 0, drawn = 0;
          for (int i = 0; i < 60; ++i) {
            TrialOptions options;
            options.strategy = strategy;
            options.tolerance_px = i % 3 == 0 ? 8.0 : 2.0;
            const Camera camera = i % 2 == 0 ? random_camera(hlod->data().box, random) : walk(hlod->data().box, i, 200);
            const Frame& frame = traverser.draw_frame(View(camera), device, options);
            EXPECT_LE(illegal_nodes(*hlod, frame), frame.stats.rarn);
            rarn += frame.stats.rarn;
            blocked += frame.stats.blocked;
            drawn += frame.stats.drawn_nodes;
          }
          EXPECT_GT(drawn, 60U);
          const bool predicts_bias = strategy == TrialStrategy::simp || strategy == TrialStrategy::coh;
          EXPECT_EQ(rarn > 0, predicts_bias) << static_cast<int>(strategy);
          const bool biased = predicts_bias || strategy == TrialStrategy::sw_b;
          EXPECT_EQ(blocked > 0, biased && grouping == Grouping::shifted) << static_cast<int>(strategy);
        }
    }
}

// Where nothing is hidden and whatever is visible counts in full, every strategy draws the front of vfc: no node is
// left behind, however late answers come.
TEST(LegalFronts, AreThatOfVfcWhereNothingIsHidden) {
  for (const Grouping grouping : {Grouping::nested, Grouping::shifted}) {
    const Hlod& hlod = city(grouping);
    const PlacedHlod placed{&hlod};
    for (const TrialStrategy strategy : asking_strategies) {
      RandomDevice device(5, 0.0), unasked(5, 0.0);
      TrialTraverser traverser({&placed, 1}), all({&placed, 1});
      std::mt19937_64 random(29);
      for (int i = 0; i < 40; ++i) {
        TrialOptions options;
        options.strategy = strategy;
        options.biased = false;
        options.tolerance_px = i % 3 == 0 ? 8.0 : 1.0;
        const View view(random_camera(hlod.data().box, random));
        const Frame& frame = traverser.draw_frame(view, device, options);
        EXPECT_EQ(illegal_nodes(hlod, frame), 0U);
        options.strategy = TrialStrategy::vfc;
        const Frame& truth = all.draw_frame(view, unasked, options);
        EXPECT_EQ(frame.front_hash, truth.front_hash);
        EXPECT_EQ(frame.stats.drawn_patches, truth.stats.drawn_patches);
        EXPECT_EQ(frame.stats.drawn_triangles, truth.stats.drawn_triangles);
      }
    }
  }
}

// With everything in sight the front is whole, with any bias: each patch of it is drawn, and nothing else. So its
// boundary is that of the input.
TEST(LegalFronts, AreWholeWhereEverythingIsInSight) {
  for (const Grouping grouping : {Grouping::nested, Grouping::shifted})
    for (const Hlod* hlod : {&city(grouping), &planet(grouping)}) {
      const PlacedHlod placed{hlod};
      for (const TrialStrategy strategy : asking_strategies) {
        RandomDevice device(5, 0.0);
        TrialTraverser traverser({&placed, 1});
        std::mt19937_64 random(37);
        std::set<std::uint64_t> fronts;
        for (int i = 0; i < 40; ++i) {
          TrialOptions options;
          options.strategy = strategy;
          options.tolerance_px = std::exp2(uniform(random, -9.0, 0.0));
          const Frame& frame = traverser.draw_frame(View(from_afar(*hlod, random)), device, options);
          std::vector<int> drawn = drawn_patches(*hlod, frame);
          const Refined refined = min_front(*hlod, drawn);
          EXPECT_EQ(clear_refined(*hlod, refined, drawn), frame.stats.rarn);
          EXPECT_EQ(drawn, patches_of(*hlod, refined));
          fronts.insert(frame.front_hash);
        }
        EXPECT_GT(fronts.size(), 8U) << static_cast<int>(strategy);
      }
    }
}

// The truth without a traversal: every node whose error is above the tolerance is refined, and the front drawn as a
// whole.
TEST(Vfc, ShowsTheFrontOfTheTolerance) {
  for (const Grouping grouping : {Grouping::nested, Grouping::shifted})
    for (const Hlod* hlod : {&city(grouping), &planet(grouping)}) {
      const PlacedHlod placed{hlod};
      TrialTraverser traverser({&placed, 1});
      SoftwareDevice device, truth;
      std::mt19937_64 random(31);
      std::size_t drawn = 0, whole = 0;
      for (int i = 0; i < 40; ++i) {
        TrialOptions options;
        options.strategy = TrialStrategy::vfc;
        options.tolerance_px = i % 8 == 0 ? 0.0 : 2.0;
        Camera camera = random_camera(hlod->data().box, random);
        if (i % 5 == 0) camera.orthographic_height = 1.0;
        const View view(camera);
        drawn += traverser.draw_frame(view, device, options).stats.drawn_patches;
        const ScreenScale scale = screen_scale(view, ObjectView(view, placed.object_to_world));
        Refined refined(hlod->node_count());
        for (NodeId n = 0; n < hlod->node_count(); ++n) {
          const double error = screen_error_px(hlod->node(n), scale);
          refined[n] = hlod->node(n).level > 0 && (options.tolerance_px == 0.0 || error > options.tolerance_px) ? 1 : 0;
        }
        truth.begin_frame(view, {&placed, 1});
        for_each_drawn(*hlod, refined, [&](NodeId n, const Patch& patch, std::size_t) {
          const DrawRange range{patch.first_index, patch.index_count};
          truth.draw({0, n, {&range, 1}});
          ++whole;
        });
        truth.end_frame();
        EXPECT_EQ(device.depth().nearness, truth.depth().nearness) << i;
      }
      EXPECT_LT(drawn, whole * 3 / 4);  // or nothing was outside
    }
}

// Stop-and-wait and what is known beforehand draw the same, biased or not, in every frame.
TEST(Ideal, IsTheFrontOfStopAndWait) {
  for (const bool biased : {false, true}) {
    const Hlod& hlod = city(Grouping::shifted);
    const PlacedHlod placed{&hlod};
    TrialTraverser waiting({&placed, 1}), ideal({&placed, 1});
    SoftwareDevice device, drawn_on, oracle;
    for (int i = 0; i < 20; ++i) {
      TrialOptions options;
      options.biased = biased;
      options.strategy = biased ? TrialStrategy::sw_b : TrialStrategy::sw;
      const View view(walk(hlod.data().box, i, 100));
      const Frame& asked = waiting.draw_frame(view, device, options);
      EXPECT_GT(asked.stats.queries, asked.stats.drawn_nodes);
      options.strategy = TrialStrategy::ideal;
      options.oracle = &oracle;
      const Frame& known = ideal.draw_frame(view, drawn_on, options);
      EXPECT_EQ(known.front_hash, asked.front_hash);
      EXPECT_EQ(known.stats.drawn_nodes, asked.stats.drawn_nodes);
      EXPECT_EQ(known.stats.queries, 0U);
      EXPECT_EQ(drawn_on.work().boxes, 0U);
      EXPECT_EQ(drawn_on.depth().nearness, device.depth().nearness);
    }
  }
}

}  // namespace
}  // namespace occlod::hlod
