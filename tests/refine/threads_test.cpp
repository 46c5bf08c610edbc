// What several threads find is what one finds, in every statistic that does not tell time.
#include <array>
#include <memory>

#include "occlod/base.h"
#include "occlod/visibility.h"
#include "refine/refine_support.h"
#include "refine/tuning.h"

namespace occlod {
namespace {

class ThreadsTest : public ::testing::TestWithParam<Culling> {
 protected:
  ThreadsTest()
      : large_(build_hierarchy(test::noisy_sphere(6, 1))),
        small_(build_hierarchy(test::noisy_sphere(4, 2))),
        objects_{{{&large_}, {&small_}}} {
    objects_[1].object_to_world[3] = {0.4, 0.3, -1.5, 1.0};
    tune(options_).culling = GetParam();
    options_.budget = 4000;
  }
  [[nodiscard]] Refinement refine(int threads, double distance, bool occlusion) {
    options_.threads = threads;
    Refiner refiner(objects_);
    NoOcclusion none;
    return refiner.refine(View(test::front_camera(distance)), options_, occlusion ? *software_ : none);
  }

  Hierarchy large_, small_;
  std::array<RefineObject, 2> objects_;
  RefineOptions options_;
  std::unique_ptr<Visibility> software_ = make_software_occlusion();
};

INSTANTIATE_TEST_SUITE_P(BothQuestions, ThreadsTest, ::testing::Values(Culling::subtree, Culling::star),
                         [](const auto& culling) { return culling.param == Culling::star ? "Star" : "Subtree"; });

TEST_P(ThreadsTest, DoNotChangeTheResult) {
  for (const bool occlusion : {false, true})
    for (const double distance : {1.3, 2.0, 6.0}) {
      const Refinement one = refine(1, distance, occlusion);
      for (const int threads : {0, 2, 5}) {
        const Refinement other = refine(threads, distance, occlusion);
        EXPECT_EQ(other.hash(), one.hash()) << threads;
        EXPECT_EQ(other.stats.visits, one.stats.visits);
        EXPECT_EQ(other.stats.queries, one.stats.queries);
        EXPECT_EQ(other.stats.queries_hidden, one.stats.queries_hidden);
        EXPECT_EQ(other.stats.culled_occlusion, one.stats.culled_occlusion);
        EXPECT_EQ(other.stats.culled_backface, one.stats.culled_backface);
        EXPECT_EQ(other.stats.forced_unseen_splits, one.stats.forced_unseen_splits);
        EXPECT_EQ(other.stats.max_error_px, one.stats.max_error_px);
        for (std::size_t i = 0; i < one.effects.size(); ++i)
          for (std::size_t k = 0; k < one.effects[i].regions.size(); ++k) {
            EXPECT_EQ(other.effects[i].regions[k].queries, one.effects[i].regions[k].queries);
            EXPECT_EQ(other.effects[i].regions[k].hidden, one.effects[i].regions[k].hidden);
          }
      }
    }
}

// From frame to frame as well, and so many nodes change that all threads have something to do.
TEST_P(ThreadsTest, DoNotChangeFrames) {
  options_.budget = 20'000;
  for (const bool occlusion : {false, true}) {
    std::vector<std::uint64_t> hashes;
    std::vector<RefineStats> stats;
    for (const int threads : {1, 2, 3, 8}) {
      options_.threads = threads;
      Refiner refiner(objects_);
      NoOcclusion none;
      for (std::size_t frame = 0; frame < 12; ++frame) {
        const double distance = 1.3 + 0.1 * static_cast<double>(frame % 7);
        const Refinement& refinement =
            refiner.update(View(test::front_camera(distance)), options_, occlusion ? *software_ : none);
        if (threads == 1) {
          hashes.push_back(refinement.hash());
          stats.push_back(refinement.stats);
          continue;
        }
        EXPECT_EQ(refinement.hash(), hashes[frame]) << threads << " threads, frame " << frame;
        EXPECT_EQ(refinement.stats.visits, stats[frame].visits);
        EXPECT_EQ(refinement.stats.queries, stats[frame].queries);
        EXPECT_EQ(refinement.stats.queries_hidden, stats[frame].queries_hidden);
        EXPECT_EQ(refinement.stats.level_px, stats[frame].level_px);
        EXPECT_EQ(refinement.stats.max_error_px, stats[frame].max_error_px);
      }
    }
  }
}

// Damage that only one of the threads comes upon is told all the same, and the refiner goes on.
TEST_P(ThreadsTest, TellOfDamage) {
  std::vector<SplitNode> nodes(large_.data().nodes.begin(), large_.data().nodes.end());
  HierarchyView view = large_.data();
  view.nodes = nodes;
  const Hierarchy damaged(view, nullptr);
  const SplitId middle = static_cast<SplitId>(large_.split_count() / 50);
  nodes[middle].parent = static_cast<SplitId>(large_.split_count() - 1);
  objects_[0].hierarchy = &damaged;
  options_.threads = 2;
  Refiner refiner(objects_);
  const View seen(test::front_camera());
  EXPECT_THROW((void)refiner.refine(seen, options_, *software_), Error);
  nodes[middle].parent = large_.node(middle).parent;
  const std::uint64_t hash = refiner.refine(seen, options_, *software_).hash();
  objects_[0].hierarchy = &large_;
  EXPECT_EQ(hash, refine(1, 4.0, true).hash());
}

}  // namespace
}  // namespace occlod
