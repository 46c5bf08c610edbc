// check_structure must refuse every array whose walk could leave the arrays: it is all that stands between a damaged
// file and a crash.
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <utility>

#include "occlod/build_hierarchy.h"
#include "splits/hierarchy_data.h"
#include "splits/star.h"
#include "support/meshes.h"

namespace occlod {
namespace {

HierarchyData good() { return copy_data(build_hierarchy(test::noisy_sphere(3, 1))); }

template <typename Change>
void expect_refused(const Change& change) {
  HierarchyData data = good();
  change(data);
  EXPECT_TRUE(check_structure(view_of(data)).has_value());
}

TEST(CheckStructure, AcceptsWhatTheBuilderMakes) { EXPECT_FALSE(check_structure(view_of(good())).has_value()); }

TEST(CheckStructure, RefusesArraysOfTheWrongLength) {
  expect_refused([](HierarchyData& d) { d.nodes.clear(); });
  expect_refused([](HierarchyData& d) { d.positions.resize(d.nodes.size() - 1); });
  expect_refused([](HierarchyData& d) { d.normals.resize(3); });
  expect_refused([](HierarchyData& d) { d.colors.resize(3); });
  expect_refused([](HierarchyData& d) { d.stars.pop_back(); });
  expect_refused([](HierarchyData& d) { d.stars.push_back(0); });
  expect_refused([](HierarchyData& d) { d.input_triangle_count = d.face_count + 1; });
}

// A split whose star is a fan that removes faces, in the middle.
SplitId some_fan(const HierarchyData& d) {
  const Hierarchy hierarchy = make_hierarchy(d);
  for (auto s = static_cast<SplitId>(d.nodes.size() / 2); s > 0; --s)
    if (star_of(hierarchy, s).is_fan() && star_of(hierarchy, s).removed_count() > 1) return s;
  return no_id;
}

TEST(CheckStructure, RefusesRangesAndIdsThatLie) {
  constexpr SplitId s = 40;
  const auto huge = std::numeric_limits<std::uint32_t>::max() - 1;
  expect_refused([&](HierarchyData& d) { d.nodes[s].star = huge; });
  expect_refused([&](HierarchyData& d) { d.nodes[s].star += 1; });
  expect_refused([&](HierarchyData& d) { d.nodes[s].child_u = s; });  // its own child: an endless descent
  expect_refused([&](HierarchyData& d) { d.nodes[s].child_v = huge; });
  expect_refused([&](HierarchyData& d) { d.nodes[s].parent = s; });
  expect_refused([&](HierarchyData& d) { d.nodes[s].parent += d.nodes[s].parent == no_id ? 0U : 1U; });
  expect_refused([&](HierarchyData& d) { d.nodes[s].sphere.radius = std::numeric_limits<float>::quiet_NaN(); });
  expect_refused([&](HierarchyData& d) { d.nodes[s].error = -1.0F; });
  expect_refused([](HierarchyData& d) { d.base_faces[0].x = static_cast<VertexId>(d.positions.size()); });
  expect_refused([](HierarchyData& d) { d.roots.push_back(d.roots[0]); });
  expect_refused([](HierarchyData& d) { d.roots.pop_back(); });
  expect_refused([](HierarchyData& d) { d.positions[7].z = std::numeric_limits<float>::infinity(); });
}

TEST(CheckStructure, RefusesStarsThatLie) {
  const auto refuse_word = [](std::size_t word, std::uint32_t value) {
    expect_refused([&](HierarchyData& d) { d.stars[d.nodes[some_fan(d)].star + word] = value; });
  };
  const auto flip_header = [](std::uint32_t bits) {
    expect_refused([&](HierarchyData& d) { d.stars[d.nodes[some_fan(d)].star] ^= bits; });
  };
  const auto huge = std::numeric_limits<std::uint32_t>::max() - 1;
  refuse_word(0, 0);         // no ring
  refuse_word(0, 31);        // a ring larger than any
  flip_header(1U);           // another ring than there is room for
  flip_header(1U << 16U);    // another number of dependencies
  flip_header(0x1FU << 8U);  // u outside the ring
  flip_header(1U << 30U);    // a bit that says nothing
  flip_header(SplitStar::other_bit);
  refuse_word(1, huge);  // a corner that is no vertex
  // A corner that comes later, a dependency that comes later, a byte that names no dependency.
  expect_refused([](HierarchyData& d) {
    const SplitId s = some_fan(d);
    d.stars[d.nodes[s].star + 1] = static_cast<VertexId>(d.positions.size() - d.nodes.size() + 1 + s + 1);
  });
  expect_refused([](HierarchyData& d) {
    const SplitId s = some_fan(d);
    d.stars[d.nodes[s].star + 1 + (d.stars[d.nodes[s].star] & 0xFFU)] = s;
  });
  expect_refused([](HierarchyData& d) { d.stars[d.nodes[some_fan(d) + 1].star - 1] |= 0x0FU; });
}

// What a removed face is called is written to by whoever applies the split: it must be a face.
TEST(CheckStructure, RefusesRemovedFacesThatNoSplitInserts) {
  expect_refused([](HierarchyData& d) {  // no fan of a smooth mesh has 16 faces
    const SplitId s = some_fan(d);
    const std::uint32_t removed = star_of(make_hierarchy(d), s).removed_count();
    d.stars[d.nodes[s + 1].star - (removed + 3) / 4] |= 0xF0U;
  });
  // Stars that are no fans, of a vertex with more neighbours than a fan has.
  BuildOptions options;
  options.base_triangles = 0;
  HierarchyData data = copy_data(build_hierarchy(test::fan(200), options));
  ASSERT_FALSE(check_structure(view_of(data)).has_value());
  std::size_t tried = 0;
  for (SplitId s = 0; s + 1 < data.nodes.size(); ++s) {
    const std::uint32_t star = data.nodes[s].star;
    if ((data.stars[star] & SplitStar::other_bit) == 0) continue;
    const std::uint32_t removed = data.stars[star + 4];
    for (std::uint32_t at = data.nodes[s + 1].star - 5 * removed; at < data.nodes[s + 1].star; at += 5) {
      if (data.stars[at] == no_id) continue;
      const std::uint32_t faces = star_of(make_hierarchy(data), data.stars[at]).inserted_count();
      for (const std::uint32_t slot : {faces, no_id - 1}) {
        const std::uint32_t good_slot = std::exchange(data.stars[at + 1], slot);
        EXPECT_TRUE(check_structure(view_of(data)).has_value()) << "split " << s << ", slot " << slot;
        data.stars[at + 1] = good_slot;
        ++tried;
      }
    }
  }
  EXPECT_GT(tried, 400U);
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
    switch (random() % 5) {
      case 0:
        data.nodes[index(data.nodes)].child_u = value;
        break;
      case 1:
        data.nodes[index(data.nodes)].star = value;
        break;
      case 2:
        data.nodes[index(data.nodes)].parent = value;
        break;
      default:
        data.stars[index(data.stars)] = value;
        break;
    }
    if (check_structure(view_of(data))) continue;
    ++accepted;
    (void)validate(make_hierarchy(std::move(data)));
  }
  EXPECT_GT(accepted, 0);
}

}  // namespace
}  // namespace occlod
