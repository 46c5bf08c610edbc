#include "refine/cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "occlod/hierarchy/build.h"
#include "support/meshes.h"

namespace occlod {
namespace {

const Hierarchy& hierarchy() {
  static const Hierarchy h = build_hierarchy(test::noisy_sphere(4, 1));
  return h;
}

std::set<SplitId> closure_by_definition(SplitId s, const Cut& cut) {
  std::set<SplitId> closure;
  std::vector<SplitId> open = {s};
  while (!open.empty()) {
    const SplitId t = open.back();
    open.pop_back();
    if (cut.applied(t) || !closure.insert(t).second) continue;
    for (const SplitId needed : hierarchy().star(t).dependencies()) open.push_back(needed);
  }
  return closure;
}

TEST(Cut, ClosureIsEverythingThatIsNeededAndMissing) {
  Cut cut(hierarchy());
  for (SplitId s = static_cast<SplitId>(hierarchy().split_count()); s-- > 0; s -= std::min(s, 97U)) {
    if (cut.applied(s)) continue;
    const std::set<SplitId> expected = closure_by_definition(s, cut);
    const Cut::Closure closure = cut.closure(s);
    EXPECT_EQ(std::set<SplitId>(closure.splits.begin(), closure.splits.end()), expected);
    EXPECT_EQ(closure.splits.size(), expected.size());  // each once
    const std::size_t before = cut.triangle_count();
    const std::size_t gain = closure.triangles;
    cut.apply_closure();
    EXPECT_EQ(cut.triangle_count(), before + gain);
    std::vector<Triangle> triangles;
    cut.active_triangles(triangles, true);
    EXPECT_EQ(triangles.size(), cut.triangle_count());
    EXPECT_TRUE(std::is_sorted(cut.applied_splits().begin(), cut.applied_splits().end()));
  }
}

TEST(Cut, ClosureThatIsNotAppliedChangesNothing) {
  Cut cut(hierarchy());
  const auto last = static_cast<SplitId>(hierarchy().split_count() - 1);
  const std::size_t first_size = cut.closure(last).splits.size();
  EXPECT_EQ(cut.closure(last).splits.size(), first_size);
  EXPECT_FALSE(cut.applied(last));
  EXPECT_EQ(cut.triangle_count(), hierarchy().base_triangle_count());
}

TEST(Cut, AllSplitsGiveTheInputAndClearGivesTheBase) {
  Cut cut(hierarchy());
  for (SplitId s = 0; s < hierarchy().split_count(); ++s) {
    if (cut.applied(s)) continue;
    (void)cut.closure(s);
    cut.apply_closure();
  }
  EXPECT_EQ(cut.triangle_count(), hierarchy().input_triangle_count());
  cut.clear();
  EXPECT_EQ(cut.triangle_count(), hierarchy().base_triangle_count());
  std::vector<Triangle> triangles;
  cut.active_triangles(triangles, false);
  const auto base = hierarchy().data().base_faces;
  EXPECT_EQ(triangles, std::vector<Triangle>(base.begin(), base.end()));
}

}  // namespace
}  // namespace occlod
