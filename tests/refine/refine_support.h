// What the refinement tests share: small objects, a camera, and independent checks of a result.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "occlod/hierarchy/build.h"
#include "occlod/refine/refiner.h"
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

// The applied splits are closed under dependency, and the triangles are those of the design's definition: a face is
// active iff the split that inserts it is applied and the one that removes it is not.
inline void expect_valid_cut(const Hierarchy& hierarchy, const RefinedObject& object) {
  const std::vector<bool> applied = applied_bits(hierarchy, object);
  for (const SplitId s : object.splits)
    for (const SplitId t : hierarchy.dependencies(s)) ASSERT_TRUE(applied[t]) << "split " << s << " without " << t;
  std::vector<FaceId> active;
  const auto& data = hierarchy.data();
  SplitId born = no_id;  // of face f: base faces first, then those of split 0, 1, ...
  for (FaceId f = 0; f < data.faces.size(); ++f) {
    while (born + 1 < hierarchy.split_count() && f >= data.nodes[born + 1].first_inserted) ++born;
    const bool is_born = born == no_id || applied[born];
    const bool has_died = data.died[f] != no_id && applied[data.died[f]];
    if (is_born && !has_died) active.push_back(f);
  }
  EXPECT_EQ(object.faces, active);
  ASSERT_EQ(object.triangles.size(), active.size());
  for (std::size_t i = 0; i < active.size(); ++i) EXPECT_EQ(object.triangles[i], hierarchy.face(active[i]));
}

// Applied splits that no other applied split depends on: taken for their own sake.
inline std::vector<SplitId> unforced_splits(const Hierarchy& hierarchy, const RefinedObject& object) {
  std::vector<bool> forced(hierarchy.split_count(), false);
  for (const SplitId s : object.splits)
    for (const SplitId t : hierarchy.dependencies(s)) forced[t] = true;
  std::vector<SplitId> unforced;
  std::copy_if(object.splits.begin(), object.splits.end(), std::back_inserter(unforced),
               [&](SplitId s) { return !forced[s]; });
  return unforced;
}

}  // namespace occlod::test
