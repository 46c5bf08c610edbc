#include "occlod/node_store.h"

#include <gtest/gtest.h>

#include <cmath>
#include <future>
#include <numeric>

#include "hlod/good_hlod.h"
#include "hlod/memory_source.h"
#include "occlod/build_hlod.h"
#include "support/error_of.h"

namespace occlod::hlod {
namespace {

using occlod::test::error_of;
using namespace test;

constexpr std::size_t plenty = std::size_t{1} << 30U;

TrialCacheOptions cache(TrialLoad load, std::size_t budget = plenty) {
  TrialCacheOptions options;
  options.budget_bytes = budget;
  options.load = load;
  return options;
}

NodeId root() { return good().data().roots[0]; }
NodeId last_leaf() { return static_cast<NodeId>(good().node_count() - 1); }

// A node and all nodes above it, ascending.
std::vector<NodeId> with_parents(NodeId n) {
  std::set<NodeId> found = {n};
  std::vector<NodeId> left = {n};
  while (!left.empty()) {
    const NodeId at = left.back();
    left.pop_back();
    for (const Patch& patch : good().patches(at))
      if (patch.parent != no_id && found.insert(patch.parent).second) left.push_back(patch.parent);
  }
  return {found.begin(), found.end()};
}

std::vector<NodeId> resident(const Hlod& hlod) {
  std::vector<NodeId> nodes;
  for (NodeId n = 0; n < hlod.node_count(); ++n)
    if (hlod.is_resident(n)) nodes.push_back(n);
  return nodes;
}

// A frame in which nothing but these nodes is wanted.
void frame(NodeStore& store, std::span<const NodeId> wanted = {}) {
  store.begin_frame();
  if (!wanted.empty()) store.want(wanted, 1.0);
  store.end_frame();
}

void expect_closed_upwards(const Hlod& hlod) {
  for (const NodeId n : resident(hlod))
    for (const Patch& patch : hlod.patches(n)) EXPECT_TRUE(patch.parent == no_id || hlod.is_resident(patch.parent));
}

TEST(NodeStore, HoldsTheMeshesThatAreThere) {
  const Hlod hlod = paged(good(), cache(TrialLoad::blocking));
  EXPECT_EQ(resident(hlod), std::vector<NodeId>(good().data().roots.begin(), good().data().roots.end()));
  NodeStore& store = *hlod.store();
  store.begin_frame();
  std::vector<NodeId> all(good().node_count());
  for (NodeId n = 0; n < all.size(); ++n) all[n] = n;
  EXPECT_TRUE(store.fetch(all));
  for (const NodeId n : all) {
    const NodeMesh mesh = hlod.mesh(n), truth = good().mesh(n);
    EXPECT_TRUE(std::ranges::equal(mesh.positions, truth.positions));
    EXPECT_TRUE(std::ranges::equal(mesh.indices, truth.indices));
    EXPECT_TRUE(std::ranges::equal(mesh.merged_into, truth.merged_into));
  }
  const StoreStats stats = store.stats();
  EXPECT_EQ(stats.resident_nodes, all.size());
  EXPECT_EQ(stats.loads, all.size());
  EXPECT_EQ(stats.resident_bytes, good().data().meshes.size());
  EXPECT_EQ(stats.bytes_loaded, good().data().meshes.size());
  // The root, and all others in one read: they lie side by side, in less than a megabyte.
  ASSERT_LT(good().data().meshes.size(), 1'000'000U);
  EXPECT_EQ(stats.reads, 2U);
}

TEST(NodeStore, WithoutAMeshThereIsAnErrorAndNotACrash) {
  const Hlod hlod = paged(good(), cache(TrialLoad::async));
  EXPECT_NO_THROW(hlod.require(root()));
  EXPECT_NE(error_of([&] { hlod.require(last_leaf()); }).find("is not in memory"), std::string::npos);
  EXPECT_THROW(hlod.require_all(), Error);
}

TEST(NodeStore, WhatNeedsAllMeshesIsRefusedEvenWhenTheyAreThere) {
  const Hlod hlod = paged(good(), cache(TrialLoad::blocking));
  std::vector<NodeId> all(hlod.node_count());
  std::iota(all.begin(), all.end(), NodeId{0});
  hlod.store()->begin_frame();
  ASSERT_TRUE(hlod.store()->fetch(all));
  EXPECT_NE(error_of([&] { hlod.require_all(); }).find("come and go"), std::string::npos);
  EXPECT_NE(error_of([&] { (void)validate(hlod); }).find("come and go"), std::string::npos);
  EXPECT_NE(error_of([&] { write_ohlod("never.ohlod", hlod, {}); }).find("come and go"), std::string::npos);
}

TEST(NodeStore, NamesTheLeastBudget) {
  const std::size_t least = bytes_of(good(), good().data().roots);
  EXPECT_NO_THROW((void)paged(good(), cache(TrialLoad::async, least)));
  EXPECT_NE(error_of([&] { (void)paged(good(), cache(TrialLoad::async, least - 1)); }).find(std::to_string(least)),
            std::string::npos);
  const Hlod hlod = paged(good(), cache(TrialLoad::async));
  EXPECT_THROW(hlod.store()->set_budget(least - 1), Error);
  EXPECT_EQ(hlod.store()->stats().budget_bytes, plenty);
}

TEST(NodeStore, RefusesOptionsOutOfTheirRange) {
  TrialCacheOptions options = cache(TrialLoad::simulated);
  for (const double speed : {0.0, -1.0, std::nan("")}) {
    options.simulated_mb_per_s = speed;
    EXPECT_THROW((void)paged(good(), options), Error);
  }
  options = cache(TrialLoad::simulated);
  options.simulated_delay = -1;
  EXPECT_THROW((void)paged(good(), options), Error);
  options = cache(TrialLoad::simulated);
  options.frame_bytes = 0;
  EXPECT_THROW((void)paged(good(), options), Error);
}

// A leaf comes with all that is above it and nothing else.
TEST(NodeStore, WhatIsThereIsClosedUpwards) {
  const Hlod hlod = paged(good(), cache(TrialLoad::blocking));
  const NodeId leaf = last_leaf();
  hlod.store()->begin_frame();
  EXPECT_TRUE(hlod.store()->fetch({&leaf, 1}));
  EXPECT_EQ(resident(hlod), with_parents(leaf));
}

// There is room for one leaf and what is above it. The second leaf comes only when the first has not been needed for
// two frames, and then what only the first needs leaves: finer ones first, of which enough is enough.
TEST(NodeStore, TheLongestUnusedLeaves) {
  const NodeId first = good().data().levels[0].first_node, second = last_leaf();
  const std::vector<NodeId> one = with_parents(first), other = with_parents(second);
  std::vector<NodeId> shared, only_other;
  std::ranges::set_intersection(one, other, std::back_inserter(shared));
  std::ranges::set_difference(other, one, std::back_inserter(only_other));
  ASSERT_GT(one.size(), shared.size() + 1);
  const std::size_t budget = std::max(bytes_of(good(), one), bytes_of(good(), other));
  const Hlod hlod = paged(good(), cache(TrialLoad::blocking, budget));
  NodeStore& store = *hlod.store();
  store.begin_frame();
  EXPECT_TRUE(store.fetch({&first, 1}));
  store.end_frame();
  store.begin_frame();
  EXPECT_FALSE(store.fetch({&second, 1}));  // the last frame needed the first
  EXPECT_FALSE(store.may_have(second));     // so it is not asked for in vain again in this frame
  EXPECT_EQ(resident(hlod), one);
  store.end_frame();
  store.begin_frame();
  EXPECT_TRUE(store.may_have(second));
  EXPECT_TRUE(store.fetch({&second, 1}));
  EXPECT_TRUE(hlod.is_resident(second));
  EXPECT_FALSE(hlod.is_resident(first));
  expect_closed_upwards(hlod);
  EXPECT_LE(store.stats().resident_bytes, budget);
  EXPECT_EQ(store.stats().evictions, one.size() + only_other.size() - store.stats().resident_nodes);
}

// A load comes when its bytes have been transferred, and the delay has passed.
TEST(NodeStore, SimulatedLoadsComeInTheFrameThatTheirBytesSay) {
  const NodeId child = good().children(root())[0];
  ASSERT_EQ(with_parents(child).size(), 2U);
  const std::size_t bytes = bytes_of(good(), child);
  for (const int delay : {0, 1, 7})
    for (const double frames : {0.5, 1.0, 2.5, 20.0}) {
      TrialCacheOptions options = cache(TrialLoad::simulated, bytes + bytes_of(good(), root()));
      options.simulated_delay = delay;
      options.simulated_mb_per_s = 60e-6 * static_cast<double>(bytes) / frames * (1.0 + 1e-9);
      const Hlod hlod = paged(good(), options);
      int passed = 0;
      frame(*hlod.store(), {&child, 1});
      for (; !hlod.is_resident(child) && passed < 100; ++passed) frame(*hlod.store(), {&child, 1});
      EXPECT_EQ(passed, static_cast<int>(std::ceil(frames)) + delay);
    }
}

// Everything is wanted at once, and comes in portions.
TEST(NodeStore, NoMoreComesInAFrameThanMay) {
  TrialCacheOptions options = cache(TrialLoad::simulated);
  options.simulated_mb_per_s = 1e6;
  options.frame_bytes = 20'000;
  const Hlod hlod = paged(good(), options);
  std::vector<NodeId> all(good().node_count());
  for (NodeId n = 0; n < all.size(); ++n) all[n] = n;
  std::uint64_t before = hlod.store()->stats().bytes_loaded;
  int frames = 0;
  for (; resident(hlod).size() < all.size() && frames < 10'000; ++frames) {
    frame(*hlod.store(), all);
    const std::uint64_t loaded = hlod.store()->stats().bytes_loaded;
    EXPECT_LE(loaded - before, options.frame_bytes);
    before = loaded;
    expect_closed_upwards(hlod);
  }
  EXPECT_GE(frames, static_cast<int>(good().data().meshes.size() / options.frame_bytes));
  EXPECT_LT(frames, 1000);
}

// All children of a node or none: what does not fit leaves no pieces behind, and does not keep what fits from coming.
TEST(NodeStore, WhatIsWantedTogetherComesTogetherOrNotAtAll) {
  const std::span<const NodeId> children = good().children(root());
  ASSERT_GT(children.size(), 2U);
  const std::size_t budget = bytes_of(good(), root()) + bytes_of(good(), children) - 1;
  TrialCacheOptions options = cache(TrialLoad::simulated, budget);
  options.simulated_mb_per_s = 1e3;
  const Hlod hlod = paged(good(), options);
  NodeStore& store = *hlod.store();
  for (int i = 0; i < 20; ++i) {
    store.begin_frame();
    store.want(children, 2.0);
    store.want(children.first(1), 1.0);
    store.end_frame();
    EXPECT_EQ(store.stats().missing, children.size() - (hlod.is_resident(children[0]) ? 1 : 0));
  }
  EXPECT_EQ(resident(hlod), (std::vector<NodeId>{root(), children[0]}));
  EXPECT_EQ(store.stats().loads, 2U);
  EXPECT_EQ(store.stats().evictions, 0U);
}

// Of two nodes that are wanted alike that one comes first for which another waits, too.
TEST(NodeStore, PrioritiesAddUp) {
  const std::span<const NodeId> children = good().children(root());
  const NodeId a = children[0], b = children[children.size() - 1];
  TrialCacheOptions options =
      cache(TrialLoad::simulated, bytes_of(good(), root()) + bytes_of(good(), a) + bytes_of(good(), b));
  options.simulated_mb_per_s = 60e-6 * static_cast<double>(std::max(bytes_of(good(), a), bytes_of(good(), b)));
  options.simulated_delay = 0;
  const Hlod hlod = paged(good(), options);
  NodeStore& store = *hlod.store();
  store.begin_frame();
  store.want({&a, 1}, 3.0);
  store.want({&b, 1}, 2.0);
  store.want({&b, 1}, 2.0);
  store.end_frame();
  store.begin_frame();
  EXPECT_TRUE(hlod.is_resident(b));
  EXPECT_FALSE(hlod.is_resident(a));
}

// What is only likely to be needed comes last, and makes nothing leave that is: even standing still for long.
TEST(NodeStore, PrefetchedMeshesTakeFreeRoomOnly) {
  const std::span<const NodeId> children = good().children(root());
  const std::size_t budget = bytes_of(good(), root()) + bytes_of(good(), children.first(2)) + 16;
  TrialCacheOptions options = cache(TrialLoad::simulated, budget);
  options.simulated_mb_per_s = 1e3;
  const Hlod hlod = paged(good(), options);
  NodeStore& store = *hlod.store();
  const auto stand_still = [&] {
    for (int i = 0; i < 50; ++i) {
      store.begin_frame();
      store.need(root());
      if (hlod.is_resident(children[0])) store.need(children[0]);
      store.want(children.first(1), 1.0);
      if (hlod.is_resident(children[0]))
        for (const NodeId n : children) store.prefetch(n);
      store.end_frame();
    }
  };
  stand_still();
  const StoreStats settled = store.stats();
  EXPECT_GT(settled.resident_nodes, 2U);
  stand_still();
  EXPECT_EQ(store.stats().loads, settled.loads);  // nothing comes and goes
  EXPECT_EQ(store.stats().evictions, settled.evictions);
  EXPECT_TRUE(hlod.is_resident(children[0]));
}

TEST(NodeStore, WhatFailsIsToldOnceAndWantedNoMore) {
  const std::span<const NodeId> children = good().children(root());
  const auto faults = std::make_shared<ReadFaults>();
  faults->damaged = {children[0]};
  faults->unreadable = {children[1]};
  TrialCacheOptions options = cache(TrialLoad::simulated);
  options.simulated_mb_per_s = 1e3;
  const Hlod hlod = paged(good(), options, faults);
  NodeStore& store = *hlod.store();
  std::vector<std::string> told;
  for (int i = 0; i < 20; ++i) {
    frame(store, children);
    for (const std::string& line : store.take_failures()) told.push_back(line);
  }
  EXPECT_EQ(told.size(), 2U);
  EXPECT_EQ(store.stats().failed, 2U);
  EXPECT_EQ(store.stats().missing, 0U);
  EXPECT_FALSE(store.may_have(children[0]) || store.may_have(children[1]));
  EXPECT_TRUE(hlod.is_resident(children[2]));  // it was read beside them
  EXPECT_EQ(store.stats().loading_bytes, 0U);
}

TEST(NodeStore, WithoutTheRootsThereIsNothing) {
  const auto faults = std::make_shared<ReadFaults>();
  faults->damaged = {root()};
  EXPECT_EQ(error_of([&] { (void)paged(good(), cache(TrialLoad::async), faults); }), "memory: node 0: is damaged");
}

TEST(NodeStore, ASmallerBudgetIsKeptAtOnce) {
  for (const TrialLoad load : {TrialLoad::async, TrialLoad::simulated}) {
    TrialCacheOptions options = cache(load, good().data().meshes.size());
    options.simulated_mb_per_s = 1.0;
    const auto faults = std::make_shared<ReadFaults>();
    faults->before = [](NodeId) { std::this_thread::sleep_for(std::chrono::milliseconds(2)); };
    const Hlod hlod = paged(good(), options, faults);
    NodeStore& store = *hlod.store();
    const std::span<const NodeId> children = good().children(root());
    for (int i = 0; i < 1'000'000 && !hlod.is_resident(children[0]); ++i) frame(store, children);
    frame(store, good().children(children[0]));  // and more is under way
    EXPECT_GT(store.stats().loading_bytes, 0U);
    const std::size_t budget = bytes_of(good(), root()) + bytes_of(good(), children[0]);
    store.set_budget(budget);
    EXPECT_LE(store.stats().resident_bytes, budget);
    EXPECT_EQ(store.stats().loading_bytes, 0U);
    expect_closed_upwards(hlod);
    EXPECT_TRUE(hlod.is_resident(root()));
    for (int i = 0; i < 100; ++i) frame(store, children);
    EXPECT_LE(store.stats().resident_bytes + store.stats().loading_bytes, budget);
  }
}

// The coarsest nodes in a sixteenth of the budget come without being asked for, and stay whatever else comes.
TEST(NodeStore, TheCoarsestNodesStay) {
  const std::span<const NodeId> children = good().children(root());
  const std::size_t coarse = bytes_of(good(), root()) + bytes_of(good(), children.first(2));
  ASSERT_EQ(children[1], 2U);
  TrialCacheOptions options = cache(TrialLoad::simulated, 16 * coarse);
  options.simulated_mb_per_s = 1e3;
  const Hlod hlod = paged(good(), options);
  NodeStore& store = *hlod.store();
  for (int i = 0; i < 10; ++i) frame(store);
  EXPECT_EQ(resident(hlod), (std::vector<NodeId>{0, 1, 2}));
  for (NodeId n = good().data().levels[0].first_node; n < good().node_count(); ++n) frame(store, {&n, 1});
  EXPECT_GT(store.stats().evictions, 0U);
  for (const NodeId n : {0U, 1U, 2U}) EXPECT_TRUE(hlod.is_resident(n));
}

// Frames never wait for a thread that reads, and what they had to do without comes in the end.
TEST(NodeStore, FramesDoNotWaitForTheDisk) {
  std::promise<void> go;
  const std::shared_future<void> gone(go.get_future());
  std::atomic<bool> is_open = false;
  const auto faults = std::make_shared<ReadFaults>();
  faults->before = [&](NodeId) {
    if (is_open) gone.wait();
  };
  const Hlod hlod = paged(good(), cache(TrialLoad::async), faults);
  is_open = true;
  NodeStore& store = *hlod.store();
  const std::span<const NodeId> children = good().children(root());
  for (int i = 0; i < 1000; ++i) frame(store, children);
  EXPECT_EQ(resident(hlod), std::vector<NodeId>{root()});
  EXPECT_EQ(store.stats().missing, children.size());
  go.set_value();
  for (int i = 0; i < 10'000 && store.stats().missing > 0; ++i) {
    frame(store, children);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(store.stats().missing, 0U);
  EXPECT_TRUE(hlod.is_resident(children[0]));
}

}  // namespace
}  // namespace occlod::hlod
