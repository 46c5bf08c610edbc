#include "refine/cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <string>

#include "occlod/build_hierarchy.h"
#include "splits/star.h"
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
    for (const SplitId needed : star_of(hierarchy(), t).dependencies()) open.push_back(needed);
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

// By definition: nothing that is applied depends on it.
bool is_leaf_by_definition(SplitId s, const Cut& cut) {
  for (SplitId t = s + 1; t < cut.hierarchy().split_count(); ++t) {
    if (!cut.applied(t)) continue;
    const std::span<const SplitId> needed = star_of(cut.hierarchy(), t).dependencies();
    if (std::find(needed.begin(), needed.end(), s) != needed.end()) return false;
  }
  return true;
}

std::vector<Triangle> triangles_of(Cut& cut) {
  std::vector<Triangle> triangles;
  cut.active_triangles(triangles, true);
  return triangles;
}

// Random steps forth and back. Afterwards the state is that of a fresh cut with the same splits: nothing of the way
// there is left. Open grids have ears, whose splits are needed for a corner alone; tetrahedra
// vanish.
class CutForthAndBack : public ::testing::TestWithParam<const char*> {
 protected:
  static TriangleMesh mesh() {
    const std::string kind = GetParam();
    if (kind == "sphere") return test::noisy_sphere(3, 1);
    if (kind == "grid") return test::grid(9, 7);
    return test::many_tetrahedra(12);
  }
};

TEST_P(CutForthAndBack, EqualsAFreshCutWithTheSameSplits) {
  BuildOptions options;
  options.base_triangles = 2;
  const Hierarchy hierarchy = build_hierarchy(mesh(), options);
  Cut cut(hierarchy);
  std::mt19937 random(7);
  const auto count = static_cast<std::uint32_t>(hierarchy.split_count());
  ASSERT_GT(count, 0U);
  std::size_t taken_back = 0;
  for (int step = 0; step < 2000; ++step) {
    const auto s = static_cast<SplitId>(random() % count);
    if (!cut.applied(s)) {
      (void)cut.closure(s);
      cut.apply_closure();
    } else {
      const bool leaf = cut.is_leaf(s);
      ASSERT_EQ(leaf, is_leaf_by_definition(s, cut)) << "split " << s << " at step " << step;
      if (!leaf) continue;
      cut.take_back(s);
      ++taken_back;
      EXPECT_FALSE(cut.applied(s));
    }
    if (step % 100 != 0) continue;
    const std::vector<Triangle> triangles = triangles_of(cut);
    ASSERT_EQ(triangles.size(), cut.triangle_count());
    Cut fresh(hierarchy);
    for (SplitId t = 0; t < count; ++t)
      if (cut.applied(t)) {
        (void)fresh.closure(t);
        fresh.apply_closure();
      }
    ASSERT_EQ(triangles_of(fresh), triangles);
    ASSERT_TRUE(std::equal(cut.applied_splits().begin(), cut.applied_splits().end(), fresh.applied_splits().begin(),
                           fresh.applied_splits().end()));
  }
  EXPECT_GT(taken_back, 100U);
}

// From random splits to others, of which most stay: the cut is that of a fresh one, whether they are closed under
// dependency, as those of cells are, or not, as those of a damaged file may be.
TEST_P(CutForthAndBack, SettingEqualsAFreshCut) {
  BuildOptions options;
  options.base_triangles = 2;
  const Hierarchy hierarchy = build_hierarchy(mesh(), options);
  std::mt19937 random(11);
  std::set<SplitId> chosen;
  Cut cut(hierarchy);
  for (int step = 0; step < 100; ++step) {
    for (int i = 0; i < 20; ++i) {
      const auto s = static_cast<SplitId>(random() % hierarchy.split_count());
      if (!chosen.insert(s).second) chosen.erase(s);
    }
    if (step % 30 == 29) chosen.clear();
    const std::vector<SplitId> splits(chosen.begin(), chosen.end());
    cut.set(splits);
    Cut fresh(hierarchy);
    for (const SplitId s : splits) {
      if (fresh.applied(s)) continue;
      (void)fresh.closure(s);
      fresh.apply_closure();
    }
    ASSERT_EQ(cut.triangle_count(), fresh.triangle_count()) << "step " << step;
    std::vector<Triangle> unsorted;
    cut.for_each_active([&](const FaceRef&, const Triangle& t) { unsorted.push_back(t); });
    ASSERT_EQ(unsorted, triangles_of(fresh));  // set() has sorted them
    ASSERT_TRUE(std::ranges::equal(cut.applied_splits(), fresh.applied_splits()));
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, CutForthAndBack, ::testing::Values("sphere", "grid", "tetrahedra"),
                         [](const auto& instance) { return instance.param; });

}  // namespace
}  // namespace occlod
