// The promise of shifted grouping: whatever is refined, nothing gapes.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <string>

#include "hlod/store/hlod_data.h"
#include "hlod/store/structure.h"
#include "occlod/build_hlod.h"
#include "occlod/generate.h"
#include "occlod/hlod.h"
#include "support/meshes.h"

namespace occlod::hlod {
namespace {

Hlod small_hlod(const TriangleMesh& mesh, Grouping grouping = Grouping::shifted, Borders borders = Borders::locked) {
  HlodBuildOptions options;
  options.node_triangles = 64;
  options.grouping = grouping;
  options.borders = borders;
  return build_hlod(mesh, options);
}

std::string violation_of(const Hlod& hlod, std::size_t fronts) {
  const std::vector<std::string> violations = validate(hlod, fronts);
  return violations.empty() ? "" : violations[0];
}

// A terrain with holes: its border has vertices whose triangles vanish in one node and stay in another.
TriangleMesh terrain_with_holes(int n) {
  TriangleMesh mesh = occlod::test::grid(n, n);
  std::mt19937_64 random(5);
  for (glm::vec3& p : mesh.positions) p.z = 0.02F * static_cast<float>(random() % 100) / 100.0F;
  std::erase_if(mesh.triangles, [&](const Triangle&) { return random() % 5 == 0; });
  std::vector<VertexId> new_id(mesh.positions.size(), no_id);
  TriangleMesh used;
  for (Triangle t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      VertexId& id = new_id[t[k]];
      if (id == no_id) {
        id = static_cast<VertexId>(used.positions.size());
        used.positions.push_back(mesh.positions[t[k]]);
      }
      t[k] = id;
    }
    used.triangles.push_back(t);
  }
  return used;
}

TEST(Fronts, TenThousandRandomFrontsHaveTheBoundaryOfTheInput) {
  EXPECT_EQ(violation_of(small_hlod(occlod::test::noisy_sphere(6, 1)), 10'000), "");
  EXPECT_EQ(violation_of(small_hlod(terrain_with_holes(100)), 10'000), "");
  EXPECT_EQ(violation_of(small_hlod(generate("city", {{"blocks", 5}, {"facade_cells", 6}})), 10'000), "");
}

TEST(Fronts, AThousandWithCutsWithinNodesToo) {
  for (const TriangleMesh& mesh : {occlod::test::noisy_sphere(6, 1), terrain_with_holes(100),
                                   generate("city", {{"blocks", 5}, {"facade_cells", 6}})}) {
    HlodBuildOptions options;
    options.node_triangles = 64;
    options.within = Within::splits;
    EXPECT_EQ(violation_of(build_hlod(mesh, options), 1'000), "");
  }
}

TEST(Fronts, FreeBordersGapeAndAreSeen) {
  // What the check is worth: the same groups with free borders, said to be locked.
  HlodData data = copy_data(small_hlod(occlod::test::noisy_sphere(6, 1), Grouping::nested, Borders::free));
  data.borders = Borders::locked;
  const std::vector<std::string> violations = validate(make_hlod(std::move(data)), 100);
  EXPECT_TRUE(std::any_of(violations.begin(), violations.end(), [](const std::string& violation) {
    return violation.find("is not a conforming mesh") != std::string::npos ||
           violation.find("both merge one vertex") != std::string::npos;
  }));
}

TEST(Fronts, RandomFrontsAreLegalAndDiffer) {
  const Hlod hlod = small_hlod(occlod::test::noisy_sphere(6, 1));
  std::mt19937_64 random(1);
  std::map<std::size_t, int> sizes;
  for (int i = 0; i < 200; ++i) {
    const Refined refined = random_front(hlod, random);
    std::size_t triangles = 0;
    for (NodeId n = 0; n < hlod.node_count(); ++n) {
      if (refined[n] == 0) continue;
      EXPECT_GT(hlod.node(n).level, 0);
      for (const Patch& patch : hlod.patches(n)) EXPECT_TRUE(patch.parent == no_id || refined[patch.parent] != 0);
    }
    for_each_drawn(hlod, refined, [&](NodeId, const Patch& patch, std::size_t) { triangles += patch.index_count / 3; });
    ++sizes[triangles];
  }
  EXPECT_GT(sizes.size(), 100U);
  EXPECT_LT(sizes.begin()->first, hlod.data().input_triangle_count / 20);
  EXPECT_GT(sizes.rbegin()->first, hlod.data().input_triangle_count * 3 / 4);
}

TEST(Fronts, EverythingRefinedIsTheInputAndNothingTheRoots) {
  const Hlod hlod = small_hlod(occlod::test::noisy_sphere(5, 1));
  const auto drawn = [&](const Refined& refined) {
    std::size_t triangles = 0;
    for_each_drawn(hlod, refined, [&](NodeId, const Patch& patch, std::size_t) { triangles += patch.index_count / 3; });
    return triangles;
  };
  Refined all(hlod.node_count(), 0);
  EXPECT_EQ(drawn(all), hlod.node(0).triangles);
  for (NodeId n = 0; n < hlod.node_count(); ++n) all[n] = hlod.node(n).level > 0 ? 1 : 0;
  EXPECT_EQ(drawn(all), hlod.data().input_triangle_count);
}

}  // namespace
}  // namespace occlod::hlod
