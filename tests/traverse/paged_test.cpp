// HLODs whose meshes come and go: what is drawn is the same front where all is there, and else a coarser one.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <set>

#include "hlod/memory_source.h"
#include "occlod/base.h"
#include "occlod/device.h"
#include "occlod/hlod.h"
#include "traverse/front_checks.h"
#include "traverse/random_device.h"
#include "traverse/small_scenes.h"
#include "traverse/traverse_support.h"

namespace occlod::hlod {
namespace {

using namespace test;

constexpr std::size_t plenty = std::size_t{1} << 30U;

TrialCacheOptions cache(TrialLoad load, std::size_t budget = plenty) {
  TrialCacheOptions options;
  options.load = load;
  options.budget_bytes = budget;
  return options;
}

std::size_t min_budget(const Hlod& hlod) { return bytes_of(hlod, hlod.data().roots); }

// Of one frame: nothing is drawn that is not there, and the budget is kept.
void expect_kept(const Hlod& hlod, const Frame& frame) {
  for (const DrawnNode& drawn : frame.draws) ASSERT_TRUE(hlod.is_resident(drawn.node));
  const StoreStats stats = hlod.store()->stats();
  ASSERT_LE(stats.resident_bytes + stats.loading_bytes, stats.budget_bytes);
}

// A store changes nothing where all meshes are at hand, with any strategy and any answers.
TEST(Paged, TheSameFrontsWhereAllIsThere) {
  for (const Grouping grouping : {Grouping::nested, Grouping::shifted}) {
    const Hlod& whole = city(grouping);
    const Hlod hlod = paged(whole, cache(TrialLoad::blocking));
    const PlacedHlod placed{&hlod}, truth{&whole};
    for (const TrialStrategy strategy :
         {TrialStrategy::vfc, TrialStrategy::sw, TrialStrategy::sw_b, TrialStrategy::boolean, TrialStrategy::simp,
          TrialStrategy::coh, TrialStrategy::ideal, TrialStrategy::nohc, TrialStrategy::optimum, TrialStrategy::batch,
          TrialStrategy::automatic, TrialStrategy::chc_plus, TrialStrategy::two_pass, TrialStrategy::cesium}) {
      TrialTraverser traverser({&placed, 1}), expected({&truth, 1});
      SoftwareDevice device, oracle;
      TrialOptions options = with(strategy, 2.0);
      options.oracle = &oracle;
      options.costs = {.draw_ns = 2000, .triangle_ns = 5, .fragment_ns = 0.2, .query_ns = 1000};
      for (int i = 0; i < 20; ++i) {
        const View view(walk(whole.data().box, i, 60));
        const Frame& frame = traverser.draw_frame(view, device, options);
        const std::uint64_t hash = frame.front_hash;
        const FrameStats stats = frame.stats;
        const Frame& wanted = expected.draw_frame(view, device, options);
        EXPECT_EQ(hash, wanted.front_hash) << static_cast<int>(strategy) << " " << i;
        EXPECT_EQ(stats.queries, wanted.stats.queries);
        EXPECT_EQ(stats.waiting_nodes + stats.missing, 0U);
      }
    }
    // Never more than is there, and not all of it: some of the city is hidden or far away.
    const StoreStats stats = hlod.store()->stats();
    EXPECT_LT(stats.resident_nodes, whole.node_count());
    EXPECT_EQ(stats.evictions, 0U);
    EXPECT_EQ(stats.loads, stats.resident_nodes);
  }
}

// Standing still, the front becomes that of the whole HLOD, and is a coarser one until then.
TEST(Paged, TheFrontBecomesThatOfAllMeshes) {
  for (const Hlod* whole : {&city(Grouping::shifted), &planet(Grouping::shifted), &city(Grouping::nested)}) {
    TrialCacheOptions options = cache(TrialLoad::simulated, whole->data().meshes.size());
    options.simulated_mb_per_s = 0.2;
    const Hlod hlod = paged(*whole, options);
    const PlacedHlod placed{&hlod}, truth{whole};
    TrialTraverser traverser({&placed, 1}), expected({&truth, 1});
    SoftwareDevice device;
    const View view(walk(whole->data().box, 3, 60));
    const Frame wanted = expected.draw_frame(view, device, with(TrialStrategy::vfc, 1.0));
    std::vector<std::size_t> triangles;
    for (int i = 0; i < 2000; ++i) {
      const Frame& frame = traverser.draw_frame(view, device, with(TrialStrategy::vfc, 1.0));
      expect_kept(hlod, frame);
      EXPECT_EQ(illegal_nodes(hlod, frame), 0U);
      EXPECT_EQ(frame.front_hash == wanted.front_hash, frame.stats.waiting_nodes == 0);
      triangles.push_back(frame.stats.drawn_triangles);
      if (frame.stats.waiting_nodes == 0) break;
      EXPECT_GT(frame.stats.missing, 0U);
      EXPECT_GT(frame.stats.largest_sse_px, 1.0);
    }
    EXPECT_EQ(triangles.back(), wanted.stats.drawn_triangles);
    EXPECT_LT(triangles.front(), triangles.back());
    EXPECT_GT(triangles.size(), 10U);
    EXPECT_LT(triangles.size(), 2000U);
  }
}

// The same loads in the same frames, whatever the machine does meanwhile.
TEST(Paged, SimulatedRunsRepeat) {
  const auto fly = [](int delay) {
    TrialCacheOptions options = cache(TrialLoad::simulated, 200'000);
    options.simulated_mb_per_s = 5.0;
    options.simulated_delay = delay;
    const auto faults = std::make_shared<ReadFaults>();
    std::mt19937_64 random(static_cast<std::uint64_t>(delay) + std::random_device()());
    faults->before = [&](NodeId) { std::this_thread::sleep_for(std::chrono::microseconds(random() % 300)); };
    const Hlod hlod = paged(city(Grouping::shifted), options, faults);
    const PlacedHlod placed{&hlod};
    TrialTraverser traverser({&placed, 1});
    SoftwareDevice device;
    std::vector<std::uint64_t> hashes;
    for (int i = 0; i < 60; ++i)
      hashes.push_back(
          traverser.draw_frame(View(walk(hlod.data().box, i, 60)), device, with(TrialStrategy::coh, 1.0)).front_hash);
    hashes.push_back(hlod.store()->stats().bytes_loaded);
    return hashes;
  };
  EXPECT_EQ(fly(1), fly(1));
  EXPECT_NE(fly(1), fly(9));
}

// What never comes leaves the coarsest picture, whole.
TEST(Paged, ALoaderThatNeverDelivers) {
  TrialCacheOptions options = cache(TrialLoad::simulated);
  options.simulated_mb_per_s = 1e-9;
  const Hlod hlod = paged(planet(Grouping::shifted), options);
  const PlacedHlod placed{&hlod};
  for (const TrialStrategy strategy :
       {TrialStrategy::vfc, TrialStrategy::coh, TrialStrategy::sw_b, TrialStrategy::boolean}) {
    TrialTraverser traverser({&placed, 1});
    RandomDevice device(3, 0.0);
    std::mt19937_64 random(41);
    for (int i = 0; i < 30; ++i) {
      TrialOptions traverse = with(strategy, 0.0);
      traverse.biased = false;
      const Frame& frame = traverser.draw_frame(View(from_afar(hlod, random)), device, traverse);
      EXPECT_EQ(drawn_patches(hlod, frame), patches_of(hlod, Refined(hlod.node_count(), 0)));
      EXPECT_EQ(frame.stats.waiting_nodes, hlod.data().roots.size());
      EXPECT_EQ(frame.stats.missing, hlod.children(hlod.data().roots[0]).size());
    }
  }
}

TEST(Paged, ACacheOfTheLeastSize) {
  for (const TrialLoad load : {TrialLoad::blocking, TrialLoad::async, TrialLoad::simulated}) {
    const Hlod& whole = planet(Grouping::shifted);
    const Hlod hlod = paged(whole, cache(load, min_budget(whole)));
    const PlacedHlod placed{&hlod};
    TrialTraverser traverser({&placed, 1});
    SoftwareDevice device;
    std::mt19937_64 random(43);
    for (int i = 0; i < 30; ++i) {
      const Frame& frame =
          traverser.draw_frame(View(from_afar(hlod, random)), device, with(TrialStrategy::coh, std::exp2(-9)));
      expect_kept(hlod, frame);
      EXPECT_EQ(frame.stats.drawn_nodes, whole.data().roots.size());
    }
    EXPECT_EQ(hlod.store()->stats().loads, whole.data().roots.size());
  }
}

// The parents of a damaged node are never refined where it would be seen; all else is as it would be.
TEST(Paged, ADamagedNodeLeavesItsParentsCoarse) {
  const Hlod& whole = planet(Grouping::shifted);
  const NodeId damaged = whole.data().levels[1].first_node + 5;
  for (const TrialLoad load : {TrialLoad::blocking, TrialLoad::simulated}) {
    const auto faults = std::make_shared<ReadFaults>();
    faults->damaged = {damaged};
    TrialCacheOptions options = cache(load);
    options.simulated_mb_per_s = 1e3;
    const Hlod hlod = paged(whole, options, faults);
    const PlacedHlod placed{&hlod};
    TrialTraverser traverser({&placed, 1});
    SoftwareDevice device;
    std::mt19937_64 random(47);
    const View view(from_afar(hlod, random));
    std::size_t told = 0;
    const Frame* frame = nullptr;
    for (int i = 0; i < 50; ++i) {
      frame = &traverser.draw_frame(view, device, with(TrialStrategy::vfc, 0.0));
      told += hlod.store()->take_failures().size();
    }
    EXPECT_EQ(told, 1U);
    EXPECT_EQ(frame->stats.missing, 0U);
    EXPECT_GT(frame->stats.waiting_nodes, 0U);
    EXPECT_EQ(illegal_nodes(hlod, *frame), 0U);
    std::vector<int> drawn = drawn_patches(hlod, *frame);
    const Refined refined = min_front(hlod, drawn);
    EXPECT_EQ(drawn, patches_of(hlod, refined));
    EXPECT_EQ(refined[damaged], 0);
    for (const Patch& patch : hlod.patches(damaged)) EXPECT_EQ(refined[patch.parent], 0);
    EXPECT_GT(std::count(refined.begin(), refined.end(), 1), static_cast<std::ptrdiff_t>(hlod.node_count() / 6));
  }
}

// What the camera is going to see is there when it gets there.
TEST(Paged, FetchesAhead) {
  const auto waiting = [](int prefetch_frames) {
    TrialCacheOptions options = cache(TrialLoad::simulated, city(Grouping::shifted).data().meshes.size());
    options.simulated_mb_per_s = 2.0;
    const Hlod hlod = paged(city(Grouping::shifted), options);
    const PlacedHlod placed{&hlod};
    TrialTraverser traverser({&placed, 1});
    RandomDevice device(1, 0.0);
    TrialOptions traverse = with(TrialStrategy::vfc, 2.0);
    traverse.prefetch_frames = prefetch_frames;
    std::size_t sum = 0;
    for (int i = 0; i < 400; ++i) {
      const std::size_t nodes =
          traverser.draw_frame(View(walk(hlod.data().box, i, 800)), device, traverse).stats.waiting_nodes;
      if (i > 50) sum += nodes;  // once what is in sight at the beginning is there
    }
    return sum;
  };
  const std::size_t without = waiting(0);
  EXPECT_GT(without, 20U);
  EXPECT_LT(waiting(15), without / 2);
}

// Two of one HLOD, and two traversers, share one store.
TEST(Paged, ManyUsersOfOneStore) {
  TrialCacheOptions options = cache(TrialLoad::simulated);
  options.simulated_mb_per_s = 20.0;
  const Hlod hlod = paged(planet(Grouping::shifted), options);
  const Hlod copy = hlod;
  std::vector<PlacedHlod> placed = {{&hlod}, {&copy}};
  placed[1].object_to_world[3] = glm::dvec4(10.0, 0.0, 0.0, 1.0);
  TrialTraverser one(placed), other({placed.data(), 1});
  SoftwareDevice device;
  std::mt19937_64 random(53);
  const View view(from_afar(hlod, random));
  for (int i = 0; i < 2000; ++i) {
    const Frame& frame = one.draw_frame(view, device, with(TrialStrategy::vfc, 0.5));
    expect_kept(hlod, frame);
    const std::size_t left = frame.stats.waiting_nodes;
    const Frame& second = other.draw_frame(view, device, with(TrialStrategy::coh, 0.25));
    expect_kept(hlod, second);
    if (left + second.stats.waiting_nodes == 0) return;
  }
  FAIL() << "something never came";
}

// One store after the other, with random budgets, speeds, delays, damaged nodes and strategies, 100,000 frames of
// random cameras: the budget is kept in every frame; what is drawn is there, and part of a legal front, or all of one
// where everything is in sight. validate() has shown of random legal fronts that they conform.
TEST(PagedFronts, AreLegalWhateverComesAndFails) {
  constexpr int stores = 100, frames = 1000;
  std::mt19937_64 random(20261124);
  for (const Hlod* hlod : {&city(Grouping::shifted), &planet(Grouping::shifted)})
    EXPECT_EQ(validate(*hlod), std::vector<std::string>());
  std::size_t waiting = 0, whole_fronts = 0, drawn_nodes = 0;
  std::uint64_t evictions = 0, failed = 0;
  for (int s = 0; s < stores; ++s) {
    const Hlod& whole = s % 2 == 0 ? city(Grouping::shifted) : planet(Grouping::shifted);
    const auto faults = std::make_shared<ReadFaults>();
    for (int i = s % 3; i > 0; --i)
      faults->damaged.insert(1 + static_cast<NodeId>(random() % (whole.node_count() - 1)));
    TrialCacheOptions options = cache(s % 4 == 3 ? TrialLoad::blocking : TrialLoad::simulated);
    const double share = std::exp2(uniform(random, -6.0, 0.5));
    options.budget_bytes =
        std::max(min_budget(whole), static_cast<std::size_t>(share * static_cast<double>(whole.data().meshes.size())));
    options.simulated_mb_per_s = std::exp2(uniform(random, -3.0, 8.0));
    options.simulated_delay = static_cast<int>(random() % 8);
    options.frame_bytes = 1 + random() % 200'000;
    const Hlod hlod = paged(whole, options, faults);
    const PlacedHlod placed{&hlod};
    TrialTraverser traverser({&placed, 1});
    RandomDevice device(random(), s % 5 == 0 ? 0.0 : 0.3);
    TrialOptions traverse;
    traverse.strategy = s % 7 == 6 ? TrialStrategy::vfc : asking_strategies[static_cast<std::size_t>(s) % 5];
    std::optional<Camera> camera;
    for (int i = 0; i < frames; ++i) {
      const bool is_far = s % 5 == 0;
      if (!camera || random() % 4 == 0)
        camera = is_far ? from_afar(hlod, random) : random_camera(hlod.data().box, random);
      traverse.tolerance_px = is_far ? std::exp2(uniform(random, -9.0, 0.0)) : 2.0;
      const Frame& frame = traverser.draw_frame(View(*camera), device, traverse);
      expect_kept(hlod, frame);
      if (HasFatalFailure()) return;
      if (is_far) {
        std::vector<int> drawn = drawn_patches(hlod, frame);
        const Refined refined = min_front(hlod, drawn);
        ASSERT_EQ(clear_refined(hlod, refined, drawn), frame.stats.rarn);
        ASSERT_EQ(drawn, patches_of(hlod, refined));
        ++whole_fronts;
      } else if (i % 10 == 0) {
        ASSERT_LE(illegal_nodes(hlod, frame), frame.stats.rarn);
      }
      if (i % 200 == 150) hlod.store()->set_budget(min_budget(whole) + random() % (options.budget_bytes + 1));
      waiting += frame.stats.waiting_nodes;
      drawn_nodes += frame.stats.drawn_nodes;
    }
    EXPECT_EQ(hlod.store()->take_failures().size(), hlod.store()->stats().failed);
    evictions += hlod.store()->stats().evictions;
    failed += hlod.store()->stats().failed;
  }
  EXPECT_GT(waiting, 10'000U);
  EXPECT_GT(drawn_nodes, 100'000U);
  EXPECT_GT(whole_fronts, 15'000U);
  EXPECT_GT(evictions, 10'000U);
  EXPECT_GT(failed, 10U);
}

}  // namespace
}  // namespace occlod::hlod
