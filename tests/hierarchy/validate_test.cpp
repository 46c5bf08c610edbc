// A validator that finds nothing is worth something only if it finds what is wrong: every invariant is broken once.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "occlod/build_hierarchy.h"
#include "splits/hierarchy_data.h"
#include "splits/packed_bounds.h"
#include "splits/star.h"
#include "support/meshes.h"

namespace occlod {
namespace {

const Hierarchy& good() {
  static const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(4, 2));
  return hierarchy;
}

// Changes one thing and expects a violation that says so.
template <typename Change>
void expect_violation(const std::string& text, const Change& change) {
  HierarchyData data = copy_data(good());
  change(data);
  const std::vector<std::string> violations = validate(make_hierarchy(std::move(data)));
  const bool found = std::any_of(violations.begin(), violations.end(),
                                 [&](const std::string& v) { return v.find(text) != std::string::npos; });
  EXPECT_TRUE(found) << "nothing says '" << text << "'" << (violations.empty() ? "" : "; but: " + violations[0]);
}

// A split with both kinds of neighbours in the forest, well inside.
SplitId inner_split() {
  for (SplitId s = 10; s < good().split_count(); ++s)
    if (good().node(s).child_u != no_id && good().node(s).child_v != no_id && good().node(s).cone().culls()) return s;
  return no_id;
}

TEST(Validate, AcceptsAGoodHierarchy) { EXPECT_TRUE(validate(good()).empty()); }

TEST(Validate, FindsAnErrorThatIsNotSaturated) {
  const SplitId s = inner_split();
  expect_violation("smaller error", [&](HierarchyData& d) { d.nodes[s].error = 0.0F; });
  expect_violation("smaller error", [&](HierarchyData& d) { d.nodes[s].guaranteed_error = 0.0F; });
}

TEST(Validate, FindsBoundsThatAreTooSmall) {
  const SplitId s = inner_split();
  expect_violation("sphere", [&](HierarchyData& d) { d.nodes[s].sphere.radius *= 0.5F; });
  const auto expect_wrong_bounds = [&](const char* what, const auto& change) {
    expect_violation(what, [&](HierarchyData& d) {
      PackedBounds bounds = packed_bounds(d.nodes[s]);
      change(bounds);
      set_packed_bounds(d.nodes[s], bounds);
    });
  };
  const auto shrink = [](std::uint16_t& step, double factor) { step = static_cast<std::uint16_t>(step * factor); };
  expect_wrong_bounds("box", [](PackedBounds& b) { b.box_max[1] -= 1000; });  // 3 % of the sphere
  expect_wrong_bounds("box", [](PackedBounds& b) { b.box_min[2] += 1000; });
  expect_wrong_bounds("cylinder", [&](PackedBounds& b) { shrink(b.cylinder_radius, 0.4); });
  expect_wrong_bounds("cylinder", [&](PackedBounds& b) { shrink(b.cylinder_t[1], 0.5); });
  expect_wrong_bounds("normal cone", [](PackedBounds& b) {
    b.cone_cos = static_cast<std::uint16_t>(b.cone_cos + (65535 - b.cone_cos) / 2);
  });
}

TEST(Validate, FindsAWrongDependency) {
  // The face that is removed belongs to the split that is named: named one lower, it is another face, or none.
  expect_violation("removes", [](HierarchyData& d) {
    for (SplitId s = 100;; ++s) {
      const SplitStar star = star_of(good(), s);
      if (!star.is_fan() || star.dependencies().empty() || star.dependencies()[0] == 0) continue;
      --d.stars[d.nodes[s].star + 1 + star.ring().size()];
      return;
    }
  });
}

TEST(Validate, FindsAFaceThatDoesNotFit) {
  // A face turned over breaks the oriented boundary of every cut that has it.
  expect_violation("conforming", [](HierarchyData& d) { std::swap(d.base_faces[0].x, d.base_faces[0].y); });
}

TEST(Validate, FindsAFaceThatIsRemovedTwice) {
  // Two bytes of a star that name the same face: the first is no longer active when the second removes it, or is
  // another face than its place in the star says.
  expect_violation("removes", [](HierarchyData& d) {
    for (SplitId s = 50;; ++s) {
      const SplitStar star = star_of(good(), s);
      if (!star.is_fan() || star.removed_count() < 2) continue;
      std::uint32_t& bytes = d.stars[d.nodes[s].star + 1 + star.ring().size() + star.dependencies().size()];
      bytes = (bytes & ~0xFFU) | ((bytes >> 8U) & 0xFFU);
      return;
    }
  });
}

TEST(Validate, FindsCountsThatLie) {
  expect_violation("triangles, not", [](HierarchyData& d) { --d.input_triangle_count; });
  expect_violation("faces, not", [](HierarchyData& d) { ++d.face_count; });
}

TEST(Validate, EachDroppedDependencyLeavesAnOpenCut) {
  // At least nine in ten dependencies are splits that inserted a face which this one removes: without them the face is
  // not there.
  std::size_t all = 0, needed = 0;
  for (SplitId s = 0; s < good().split_count(); ++s) {
    const SplitStar star = star_of(good(), s);
    all += star.dependencies().size();
    std::set<SplitId> of_removed;
    star.for_each_removed([&](const FaceRef& face, const Triangle&) { of_removed.insert(face.split); });
    for (const SplitId t : star.dependencies()) needed += of_removed.count(t);
  }
  EXPECT_GT(needed, all * 9 / 10);
}

}  // namespace
}  // namespace occlod
