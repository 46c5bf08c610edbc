// What the refinement tests share: small objects, a camera, and independent checks of a result.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "occlod/build_hierarchy.h"
#include "occlod/refiner.h"
#include "splits/star.h"
#include "support/meshes.h"

namespace occlod::test {

inline Camera front_camera(double distance = 4.0) {
  Camera camera;
  camera.eye = {0.3, 0.4, distance};
  camera.width = 320;
  camera.height = 240;
  camera.near = 0.01;
  camera.far = 100.0;
  return camera;
}

inline std::vector<bool> applied_bits(const Hierarchy& hierarchy, const RefinedObject& object) {
  std::vector<bool> applied(hierarchy.split_count(), false);
  for (const SplitId s : object.splits) applied[s] = true;
  return applied;
}

// By the design's definition: a face is active iff the split that inserts it is applied and none that removes it is.
// Base faces first, then by split and slot.
inline std::vector<Triangle> active_triangles(const Hierarchy& hierarchy, const std::vector<SplitId>& splits) {
  std::set<std::pair<SplitId, std::uint32_t>> removed;
  for (const SplitId s : splits)
    star_of(hierarchy, s).for_each_removed([&](const FaceRef& f, const Triangle&) {
      removed.emplace(f.split, f.slot);
    });
  std::vector<Triangle> active;
  const auto add = [&](const Triangle& t, SplitId split, std::uint32_t slot) {
    if (!removed.contains({split, slot})) active.push_back(t);
  };
  for (std::uint32_t slot = 0; slot < hierarchy.base_triangle_count(); ++slot)
    add(hierarchy.data().base_faces[slot], no_id, slot);
  for (const SplitId s : splits)
    for (std::uint32_t slot = 0; slot < star_of(hierarchy, s).inserted_count(); ++slot)
      add(star_of(hierarchy, s).inserted(slot), s, slot);
  return active;
}

inline void expect_closed(const Hierarchy& hierarchy, const RefinedObject& object) {
  const std::vector<bool> applied = applied_bits(hierarchy, object);
  for (const SplitId s : object.splits)
    for (const SplitId t : star_of(hierarchy, s).dependencies())
      ASSERT_TRUE(applied[t]) << "split " << s << " without " << t;
}

// The applied splits are closed under dependency, and the triangles are the active ones in order.
inline void expect_valid_cut(const Hierarchy& hierarchy, const RefinedObject& object) {
  expect_closed(hierarchy, object);
  EXPECT_EQ(object.triangles, active_triangles(hierarchy, object.splits));
}

// Applied splits that no other applied split depends on: taken for their own sake.
inline std::vector<SplitId> unforced_splits(const Hierarchy& hierarchy, const RefinedObject& object) {
  std::vector<bool> forced(hierarchy.split_count(), false);
  for (const SplitId s : object.splits)
    for (const SplitId t : star_of(hierarchy, s).dependencies()) forced[t] = true;
  std::vector<SplitId> unforced;
  std::copy_if(object.splits.begin(), object.splits.end(), std::back_inserter(unforced),
               [&](SplitId s) { return !forced[s]; });
  return unforced;
}

}  // namespace occlod::test
