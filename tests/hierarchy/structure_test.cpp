// check_structure must refuse every array whose walk could leave the arrays: it is all that stands between a damaged
// file and a crash.
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "occlod/hierarchy/build.h"
#include "occlod/hierarchy/validate.h"
#include "support/meshes.h"

namespace occlod {
namespace {

HierarchyData good() { return build_hierarchy(test::noisy_sphere(3, 1)).data(); }

template <typename Change>
void expect_refused(const Change& change) {
  HierarchyData data = good();
  change(data);
  EXPECT_TRUE(check_structure(data).has_value());
}

TEST(CheckStructure, AcceptsWhatTheBuilderMakes) { EXPECT_FALSE(check_structure(good()).has_value()); }

TEST(CheckStructure, RefusesArraysOfTheWrongLength) {
  expect_refused([](HierarchyData& d) { d.nodes.clear(); });
  expect_refused([](HierarchyData& d) { d.positions.resize(d.nodes.size() - 1); });
  expect_refused([](HierarchyData& d) { d.normals.resize(3); });
  expect_refused([](HierarchyData& d) { d.colors.resize(3); });
  expect_refused([](HierarchyData& d) { d.died.pop_back(); });
  expect_refused([](HierarchyData& d) { d.boxes.pop_back(); });
  expect_refused([](HierarchyData& d) { d.cylinders.pop_back(); });
  expect_refused([](HierarchyData& d) { d.first_dependency.pop_back(); });
  expect_refused([](HierarchyData& d) { d.dependencies.push_back(0); });
  expect_refused([](HierarchyData& d) { d.removed_faces.pop_back(); });
}

TEST(CheckStructure, RefusesRangesAndIdsThatLie) {
  constexpr SplitId s = 40;
  const auto huge = std::numeric_limits<std::uint32_t>::max() - 1;
  expect_refused([&](HierarchyData& d) { d.nodes[s].first_inserted = huge; });
  expect_refused([&](HierarchyData& d) { d.nodes[s].first_inserted = 0; });
  expect_refused([&](HierarchyData& d) { d.nodes[s].first_removed = huge; });
  expect_refused([&](HierarchyData& d) { d.nodes[s].parent_vertex = huge; });
  expect_refused([&](HierarchyData& d) { d.nodes[s].child_u = s; });  // its own child: an endless descent
  expect_refused([&](HierarchyData& d) { d.nodes[s].child_v = huge; });
  expect_refused([&](HierarchyData& d) { d.nodes[s].level += 1; });
  expect_refused([&](HierarchyData& d) { d.first_dependency[s] = huge; });
  expect_refused(
      [&](HierarchyData& d) { d.dependencies.back() = static_cast<SplitId>(d.nodes.size() - 2); });  // needs itself
  expect_refused([](HierarchyData& d) { d.faces[0].x = static_cast<VertexId>(d.positions.size()); });
  expect_refused([](HierarchyData& d) { d.faces.back().y = static_cast<VertexId>(d.positions.size()); });
  expect_refused([](HierarchyData& d) { d.removed_faces.back() = static_cast<FaceId>(d.faces.size() - 1); });
  expect_refused([](HierarchyData& d) { d.died[d.removed_faces[0]] = no_id; });
  expect_refused([](HierarchyData& d) { d.died.back() = 0; });
  expect_refused([](HierarchyData& d) { d.roots.push_back(d.roots[0]); });
  expect_refused([](HierarchyData& d) { d.roots.pop_back(); });
  expect_refused([](HierarchyData& d) { d.positions[7].z = std::numeric_limits<float>::infinity(); });
}

TEST(CheckStructure, WhatItAcceptsCanBeWalked) {
  // Random words of random arrays overwritten: whatever still passes must be safe to validate, that is, end and stay
  // inside the arrays.
  std::mt19937 random(7);
  int accepted = 0;
  for (int n = 0; n < 400; ++n) {
    HierarchyData data = good();
    const auto index = [&](const auto& v) { return random() % v.size(); };
    const auto value = static_cast<std::uint32_t>(random() % 2 == 0 ? random() : random() % 500);
    switch (random() % 6) {
      case 0:
        data.nodes[index(data.nodes)].child_u = value;
        break;
      case 1:
        data.nodes[index(data.nodes)].first_inserted = value;
        break;
      case 2:
        data.dependencies[index(data.dependencies)] = value;
        break;
      case 3:
        data.faces[index(data.faces)][static_cast<int>(random() % 3)] = value;
        break;
      case 4:
        data.died[index(data.died)] = value;
        break;
      default:
        data.removed_faces[index(data.removed_faces)] = value;
        break;
    }
    if (check_structure(data)) continue;
    ++accepted;
    (void)validate(Hierarchy(std::move(data)));
  }
  EXPECT_GT(accepted, 0);
}

}  // namespace
}  // namespace occlod
