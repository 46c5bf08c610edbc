#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <tuple>
#include <vector>

#include "occlod/build_hierarchy.h"
#include "refine/drawn_mesh.h"
#include "splits/star.h"
#include "support/meshes.h"

namespace occlod {
namespace {

std::vector<Triangle> sorted(std::vector<Triangle> triangles) {
  std::sort(triangles.begin(), triangles.end(),
            [](const Triangle& a, const Triangle& b) { return std::tuple(a.x, a.y, a.z) < std::tuple(b.x, b.y, b.z); });
  return triangles;
}

// A cut and its list of faces under random splits and merges.
class RandomWalk {
 public:
  RandomWalk(const Hierarchy& hierarchy, unsigned seed) : cut(hierarchy), faces(hierarchy, triangles), random_(seed) {
    faces.assign(cut);
  }

  // Up to `steps` splits and merges, and what they force.
  void step(int steps) {
    faces.begin_frame();
    for (int k = 0; k < steps; ++k) {
      const auto s = static_cast<SplitId>(random_() % cut.hierarchy().split_count());
      if (!cut.applied(s)) {
        apply(s);
      } else {
        // Down to a leaf: one of those that need s, if any does.
        take_back_above(s);
      }
    }
  }

  Cut cut;
  std::vector<Triangle> triangles;
  FaceList faces;

 private:
  void apply(SplitId s) {
    const Cut::Closure closure = cut.closure(s);
    std::vector<SplitId> order(closure.splits.begin(), closure.splits.end());
    std::sort(order.begin(), order.end());
    cut.apply_closure();
    for (const SplitId t : order) faces.apply(t);
  }

  void take_back_above(SplitId s) {
    for (auto t = static_cast<SplitId>(cut.hierarchy().split_count()); t-- > s;) {
      if (!cut.applied(t) || !cut.is_leaf(t)) continue;
      cut.take_back(t);
      faces.take_back(t);
      if (t == s || random_() % 4 == 0) return;
    }
  }

  std::mt19937 random_;
};

// After 100,000 frames of random splits and merges the kept state is what a fresh one for the same set is: a bit that
// was set or cleared once too often, or a place that was lost, would stay wrong from then on.
TEST(FaceList, DoesNotDrift) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(3, 7));
  RandomWalk walk(hierarchy, 11);
  constexpr int frames = 100'000, checks = 500;
  for (int frame = 0; frame < frames; ++frame) {
    walk.step(1 + frame % 5);
    if (frame % (frames / checks) != 0 && frame != frames - 1) continue;
    Cut fresh(hierarchy);
    for (SplitId s = 0; s < hierarchy.split_count(); ++s)
      if (walk.cut.applied(s) && !fresh.applied(s)) {
        ASSERT_EQ(fresh.closure(s).splits.size(), 1U) << "the set is not closed at " << s;
        fresh.apply_closure();
      }
    std::vector<Triangle> expected, kept;
    fresh.active_triangles(expected, true);
    walk.cut.active_triangles(kept, true);
    ASSERT_TRUE(kept == expected) << frame;
    ASSERT_EQ(walk.cut.triangle_count(), fresh.triangle_count());
    for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
      if (!fresh.applied(s)) continue;
      ASSERT_EQ(walk.cut.is_leaf(s), fresh.is_leaf(s)) << s;
    }
    ASSERT_TRUE(sorted(walk.triangles) == sorted(expected)) << frame;
  }
}

// What changes() leaves out is as it was, and what it tells is within the list.
TEST(FaceList, ChangesMakeTheBufferOfTheFrameBeforeThatOfThisFrame) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(3, 7));
  RandomWalk walk(hierarchy, 5);
  std::vector<Triangle> buffer = walk.triangles;
  std::vector<TriangleRange> changes;
  for (int frame = 0; frame < 2000; ++frame) {
    walk.step(frame % 7);
    walk.faces.changes(changes);
    const std::vector<Triangle>& triangles = walk.triangles;
    buffer.resize(triangles.size());
    std::uint32_t end = 0;
    for (const TriangleRange& range : changes) {
      ASSERT_GE(range.first, end);
      ASSERT_GT(range.count, 0U);
      end = range.first + range.count;
      ASSERT_LE(end, triangles.size());
      std::copy_n(triangles.begin() + range.first, range.count, buffer.begin() + range.first);
    }
    ASSERT_TRUE(buffer == triangles) << frame;
    if (frame % 7 == 0) {
      EXPECT_TRUE(changes.empty());
    }
  }
}

// A split replaces few faces: those that stay keep their places.
TEST(FaceList, OneSplitChangesFewPlaces) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(4, 7));
  Cut cut(hierarchy);
  for (SplitId s = 0; s < hierarchy.split_count() / 2; ++s) {
    if (cut.applied(s)) continue;
    static_cast<void>(cut.closure(s));
    cut.apply_closure();
  }
  std::vector<Triangle> triangles;
  FaceList faces(hierarchy, triangles);
  faces.assign(cut);
  std::vector<TriangleRange> changes;
  for (SplitId s = static_cast<SplitId>(hierarchy.split_count() / 2); s < hierarchy.split_count(); ++s) {
    if (cut.applied(s) || cut.closure(s).splits.size() != 1) continue;
    cut.apply_closure();
    faces.begin_frame();
    faces.apply(s);
    faces.changes(changes);
    std::uint32_t changed = 0;
    for (const TriangleRange& range : changes) changed += range.count;
    EXPECT_EQ(changed, star_of(hierarchy, s).inserted_count()) << s;  // which take the places of those that are removed
  }
}

}  // namespace
}  // namespace occlod
