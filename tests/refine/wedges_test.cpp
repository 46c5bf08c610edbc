// Refinement of meshes with seams.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>

#include "occlod/build_hierarchy.h"
#include "occlod/refiner.h"
#include "refine/refine_support.h"
#include "support/wedge_meshes.h"

namespace occlod {
namespace {

TriangleMesh many_charts() {
  TriangleMesh mesh = test::grid_of_charts(
      64, [](int i, int j) { return (i / 8) * 8 + j / 8; }, [](int i, int) { return i / 32; });
  for (glm::vec3& p : mesh.positions) p = {4.0F * p.x - 2.0F, 4.0F * p.y - 2.0F, 0.3F * std::sin(9.0F * p.x * p.y)};
  return mesh;
}

// By their vertices: the triangles that the splits give.
void expect_wedges_of_cut(const Hierarchy& hierarchy, const RefinedObject& object, bool in_order) {
  std::vector<Triangle> vertices, expected = test::active_triangles(hierarchy, object.splits);
  FixedCut cut;
  cut.applied = test::applied_bits(hierarchy, object);
  std::vector<Triangle> wedges = wedge_triangles_of(hierarchy, cut), drawn = object.triangles;
  for (const Triangle& t : object.triangles) {
    vertices.emplace_back(hierarchy.vertex_of_wedge(t.x), hierarchy.vertex_of_wedge(t.y),
                          hierarchy.vertex_of_wedge(t.z));
    EXPECT_EQ(hierarchy.material_of(t.x), hierarchy.material_of(t.y));
    EXPECT_EQ(hierarchy.material_of(t.x), hierarchy.material_of(t.z));
  }
  const auto less = [](const Triangle& a, const Triangle& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  if (!in_order)
    for (auto* list : {&vertices, &expected, &wedges, &drawn}) std::sort(list->begin(), list->end(), less);
  EXPECT_TRUE(vertices == expected);
  EXPECT_TRUE(drawn == wedges);
}

TEST(RefinedWedges, AreThoseOfTheCut) {
  const Hierarchy hierarchy = build_hierarchy(many_charts());
  ASSERT_TRUE(hierarchy.has_seams());
  std::array<RefineObject, 1> objects{{{&hierarchy, glm::dmat4(1.0), true}}};
  Refiner refiner(objects);
  NoOcclusion none;
  RefineOptions options;
  options.budget = 1500;
  expect_wedges_of_cut(hierarchy, refiner.refine(View(test::front_camera()), options, none).objects[0], true);
  for (const double distance : {4.0, 3.0, 2.0, 2.5, 6.0}) {
    const Refinement& result = refiner.update(View(test::front_camera(distance)), options, none);
    EXPECT_LE(result.stats.triangles, options.budget);
    expect_wedges_of_cut(hierarchy, result.objects[0], false);
  }
}

TEST(RefinedWedges, AToleranceCoversHowFarTexturesSlip) {
  // A flat square whose texture is stretched to one side: only the texture asks for triangles.
  TriangleMesh mesh = test::grid_of_charts(
      48, [](int, int) { return 0; }, [](int, int) { return 0; });
  for (glm::vec2& t : mesh.texture_coordinates) t.x = t.x * t.x * t.x;
  BuildOptions build;
  build.base_triangles = 2;
  const Hierarchy hierarchy = build_hierarchy(mesh, build);
  const auto triangles = [&](bool attributes, double tolerance) {
    std::array<RefineObject, 1> objects{{{&hierarchy, glm::dmat4(1.0), true, attributes}}};
    Refiner refiner(objects);
    NoOcclusion none;
    RefineOptions options;
    options.budget = refiner.full_triangles();
    options.tolerance_px = tolerance;
    const Refinement& result = refiner.refine(View(test::front_camera(2.0)), options, none);
    EXPECT_LE(result.stats.max_error_px, tolerance);
    return result.stats.triangles;
  };
  EXPECT_GT(triangles(true, 0.5), 2 * triangles(false, 0.5));
  EXPECT_GT(triangles(true, 0.1), triangles(true, 0.5));
}

TEST(RefinedWedges, AreGroupedByMaterial) {
  const Hierarchy hierarchy = build_hierarchy(many_charts());
  FixedCut cut = cut_to_triangles(hierarchy, 900);
  const std::vector<Triangle> triangles = wedge_triangles_of(hierarchy, cut);
  MaterialRanges groups;
  group_by_material(hierarchy, triangles, groups);
  ASSERT_EQ(groups.ranges.size(), 2U);
  EXPECT_EQ(groups.ranges[0].material, 0U);
  EXPECT_EQ(groups.ranges[1].first, groups.ranges[0].count);
  std::vector<Triangle> expected;
  for (const MaterialRange& range : groups.ranges)
    for (const Triangle& t : triangles)
      if (hierarchy.material_of(t.y) == range.material) expected.push_back(t);
  EXPECT_TRUE(groups.triangles == expected);
  // Without materials there is one range, and none without triangles.
  const Hierarchy plain = build_hierarchy(test::noisy_sphere(2, 1));
  group_by_material(plain, triangles_of(plain, full_cut(plain)), groups);
  ASSERT_EQ(groups.ranges.size(), 1U);
  EXPECT_EQ(groups.ranges[0].count, plain.input_triangle_count());
  group_by_material(hierarchy, {}, groups);
  EXPECT_TRUE(groups.ranges.empty());
}

TEST(RefinedWedges, GeomorphsDoNotTearSeams) {
  const Hierarchy hierarchy = build_hierarchy(many_charts());
  std::array<RefineObject, 1> objects{{{&hierarchy, glm::dmat4(1.0), true}}};
  Refiner refiner(objects);
  NoOcclusion none;
  RefineOptions options;
  options.budget = 1500;
  options.geomorph_frames = 5;
  MorphedPositions drawn(hierarchy.positions());
  std::size_t wedges_under_way = 0;
  for (int frame = 0; frame < 12; ++frame) {
    const Refinement& result = refiner.update(View(test::front_camera(4.0 - 0.2 * frame)), options, none);
    const RefinedObject& object = result.objects[0];
    drawn.update(object.geomorphs);
    for (const Geomorph& g : object.geomorphs) wedges_under_way += g.vertex >= hierarchy.vertex_count() ? 1U : 0U;
    for (std::size_t i = 0; i < hierarchy.data().extra_wedges.size(); ++i) {
      const VertexId v = hierarchy.data().extra_wedges[i];
      ASSERT_EQ(drawn.positions()[hierarchy.vertex_count() + i], drawn.positions()[v]) << "frame " << frame;
    }
    // A wedge slides from one of the same material.
    for (const Geomorph& g : object.geomorphs)
      if (g.parent >= hierarchy.vertex_count()) {
        EXPECT_EQ(hierarchy.material_of(g.vertex), hierarchy.material_of(g.parent));
      }
  }
  EXPECT_GT(wedges_under_way, 100U);
}

}  // namespace
}  // namespace occlod
