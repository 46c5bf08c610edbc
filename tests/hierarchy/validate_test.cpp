// A validator that finds nothing is worth something only if it finds what is wrong: every invariant is broken once.
#include "occlod/hierarchy/validate.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "occlod/hierarchy/build.h"
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
  HierarchyData data = good().data();
  change(data);
  const std::vector<std::string> violations = validate(Hierarchy(std::move(data)));
  const bool found = std::any_of(violations.begin(), violations.end(),
                                 [&](const std::string& v) { return v.find(text) != std::string::npos; });
  EXPECT_TRUE(found) << "nothing says '" << text << "'" << (violations.empty() ? "" : "; but: " + violations[0]);
}

// A split with both kinds of neighbours in the forest, well inside.
SplitId inner_split() {
  for (SplitId s = 10; s < good().split_count(); ++s)
    if (good().node(s).child_u != no_id && good().node(s).child_v != no_id && good().node(s).cone.culls()) return s;
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
  expect_violation("sphere", [&](HierarchyData& d) { d.nodes[s].sphere.radius *= 0.85F; });
  expect_violation("box", [&](HierarchyData& d) { d.boxes[s].max.y -= 0.02F * (d.boxes[s].max.y - d.boxes[s].min.y); });
  expect_violation("cylinder", [&](HierarchyData& d) { d.cylinders[s].radius *= 0.7F; });
  expect_violation("cylinder", [&](HierarchyData& d) { d.cylinders[s].t_max *= 0.3F; });
  expect_violation("normal cone",
                   [&](HierarchyData& d) { d.nodes[s].cone.cos_angle += 0.5F * (1.0F - d.nodes[s].cone.cos_angle); });
}

TEST(Validate, FindsADroppedDependency) {
  // Without it some closed set applies a split whose faces do not fit what is there. Which random set shows it is luck,
  // so many are dropped.
  expect_violation("", [](HierarchyData& d) {
    for (SplitId s = 100; s + 1 < d.nodes.size(); s += 3) {
      const std::uint32_t first = d.first_dependency[s];
      if (d.first_dependency[s + 1] == first) continue;
      d.dependencies.erase(d.dependencies.begin() + first);
      for (std::size_t t = s + 1; t < d.first_dependency.size(); ++t) --d.first_dependency[t];
    }
  });
}

TEST(Validate, FindsAFaceThatDoesNotFit) {
  // A face turned over breaks the oriented boundary of every cut that has it.
  expect_violation("conforming", [](HierarchyData& d) { std::swap(d.faces[0].x, d.faces[0].y); });
}

TEST(Validate, EachDroppedDependencyLeavesAnOpenCut) {
  // The dependency itself, shown to be needed: apply s with all that it needs except one direct dependency, and the cut
  // has a face removed that is not active, or lacks a corner. Counted over all splits: at least nine in ten
  // dependencies are needed for the faces that they inserted.
  const HierarchyData& d = good().data();
  std::size_t needed = 0;
  for (SplitId s = 0; s < good().split_count(); ++s)
    for (const SplitId t : good().dependencies(s)) {
      const auto removed = good().removed(s);
      if (std::any_of(removed.begin(), removed.end(),
                      [&](FaceId f) { return f >= d.nodes[t].first_inserted && f < d.nodes[t + 1].first_inserted; }))
        ++needed;
    }
  EXPECT_GT(needed, d.dependencies.size() * 9 / 10);
}

}  // namespace
}  // namespace occlod
