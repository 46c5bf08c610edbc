#include "occlod/cell_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <thread>

#include "cell_sight.h"
#include "cells/cell_refinement.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "splits/star.h"
#include "support/holed_meshes.h"
#include "support/meshes.h"

namespace occlod {
namespace {

CellBox around(const glm::dvec3& center, const glm::dvec3& size) { return {center - 0.5 * size, center + 0.5 * size}; }

struct CellScene {
  const char* name;
  TriangleMesh mesh;
  double max_motion;
  double near;
  std::vector<CellBox> cells;
};

CellScene city() {
  return {"city",
          generate("city", {{"blocks", 3}, {"facade_cells", 4}}),
          0.5,
          0.1,
          {around({60, 60, 1.7}, {4, 4, 1.5}), around({60, 90, 1.7}, {8, 8, 1.5}), around({90, 70, 30}, {8, 8, 8}),
           around({120, 55, 6}, {2, 2, 2})}};
}
CellScene planet() {
  return {"planet",
          generate("rough-planet", {{"level", 4}}),
          0.02,
          0.01,
          {around({0, 0, 1.2}, glm::dvec3(0.1)), around({0.7, 0.7, 0.7}, glm::dvec3(0.05)),
           around({0, 3, 0}, glm::dvec3(1)), around({0, -1.3, 0.1}, glm::dvec3(0.2))}};
}
CellScene spheres_behind_wall() {
  return {"spheres_behind_wall",
          generate("spheres-behind-wall", {{"spheres", 24}, {"level", 2}, {"wall_cells", 8}}),
          0.02,
          0.01,
          {around({1, 0, 0}, glm::dvec3(0.5)), around({0.3, 0.9, 0}, glm::dvec3(0.2)),
           around({-0.5, 0, 0}, glm::dvec3(0.1)), around({0.5, 1.5, 0.5}, glm::dvec3(0.3))}};
}
CellScene windows() {
  TriangleMesh mesh = test::sheet_with_windows();
  test::append(mesh, test::noisy_sphere(3, 4), {0, 0, -1.5F});
  return {"windows",
          std::move(mesh),
          0.03,
          0.01,
          {around({0, 0, 1}, glm::dvec3(0.1)), around({0.3, 0.2, 0.2}, glm::dvec3(0.05)),
           around({1.5, 0, 1}, glm::dvec3(0.2)), around({0, 0, -0.3}, glm::dvec3(0.05))}};
}

class CellPromise : public testing::TestWithParam<CellScene (*)()> {};
INSTANTIATE_TEST_SUITE_P(Scenes, CellPromise, testing::Values(&city, &planet, &spheres_behind_wall, &windows),
                         [](const auto& param) { return std::string(param.param().name); });

// From random eyes of cells, to all sides: what is seen of the input is within the tolerance of what is drawn.
TEST_P(CellPromise, EverythingSeenIsDrawn) {
  const CellScene scene = GetParam()();
  const Hierarchy hierarchy = build_hierarchy(scene.mesh);
  const RefineObject objects[] = {{.hierarchy = &hierarchy}};
  const CellOccluders occluders(objects, scene.max_motion);
  const CellOptions options{.eyes = tool::cube_eyes(128, scene.near)};
  CellBuilder none(objects, nullptr, options), hull(objects, &occluders, options);
  const tool::FullScene full(objects);
  std::uint64_t seed = 13;
  std::size_t hidden = 0;
  for (const CellBox& cell : scene.cells) {
    const std::size_t drawn_without = none.build(cell).drawn_triangles;
    const CellCut& cut = hull.build(cell);
    EXPECT_LE(cut.error_px, options.tolerance_px);
    EXPECT_LE(cut.drawn_triangles, drawn_without);
    const tool::CellSight sight = tool::look_from(cell, full, objects, options, cut.objects, {41, 64, seed++});
    EXPECT_EQ(sight.missing, 0U);
    EXPECT_GT(sight.pixels, 1000U);
    hidden += cut.stats.queries_hidden;
  }
  EXPECT_GT(hidden, 50U);
}

// The same where objects are sheared and mirrored, and some two-sided.
TEST(CellPromise, HoldsForPlacedObjects) {
  const Hierarchy ball = build_hierarchy(test::noisy_sphere(4, 2)), sheet = build_hierarchy(test::sheet_with_windows());
  glm::dmat4 sheared = glm::scale(glm::dmat4(1.0), {-2.0, 1.0, 0.5});
  sheared[1][0] = 0.7;
  const RefineObject objects[] = {{&ball, sheared},
                                  {&sheet, glm::translate(glm::dmat4(1.0), {0, 0, 2}), true},
                                  {&ball, glm::translate(glm::dmat4(1.0), {0, 0, 4})}};
  const CellOccluders occluders(objects, 0.03);
  const CellOptions options{.eyes = tool::cube_eyes(128, 0.01)};
  CellBuilder builder(objects, &occluders, options);
  const tool::FullScene full(objects);
  std::uint64_t seed = 17;
  for (const glm::dvec3 center : {glm::dvec3(0, 0, -1.5), glm::dvec3(0, 0, 1.5), glm::dvec3(3, 0, 2)}) {
    const CellBox cell = around(center, glm::dvec3(0.1));
    const CellCut& cut = builder.build(cell);
    EXPECT_EQ(tool::look_from(cell, full, objects, options, cut.objects, {20, 64, seed++}).missing, 0U);
    EXPECT_GT(cut.stats.queries_hidden, 0U);
  }
}

// A sheet from x = -2 to 0 and z = -4 to 4, but for a point in the middle of its border that sticks out to x = 0.3.
TriangleMesh pointed_sheet() {
  TriangleMesh mesh = test::grid(4, 8);
  for (glm::vec3& p : mesh.positions) p = {2.0F * p.x - 2.0F, 0.0F, 8.0F * p.y - 4.0F};
  for (glm::vec3& p : mesh.positions)
    if (p.x == 0.0F && p.z == 0.0F) p.x = 0.3F;
  return mesh;
}

// Only the point of the sheet shows beside a wall. Where leaving it out is within the tolerance, the straight sheet has
// to be drawn for it, though all of that is hidden.
std::size_t missing_beside_a_wall() {
  const Hierarchy sheet = build_hierarchy(pointed_sheet(), {.base_triangles = 2});
  TriangleMesh mesh = test::grid(1, 1);
  for (glm::vec3& p : mesh.positions) p = {8.125F * p.x - 8.0F, -6.0F, 8.0F * p.y - 4.0F};  // to x = 0.125
  const Hierarchy wall = build_hierarchy(mesh);
  const RefineObject objects[] = {{&sheet, glm::dmat4(1.0), true}, {&wall, glm::dmat4(1.0), true}};
  const CellSurface surface(objects, 0.0);
  const CellOptions options{.eyes = tool::cube_eyes(128, 0.01), .tolerance_px = 14.0};
  const CellBox cell = around({0.1, -8.0, 0}, glm::dvec3(0.02));  // sees what is beyond x = 0.2 there
  CellRefinement refinement(objects, &surface, nullptr, options);
  return tool::look_from(cell, tool::FullScene(objects), objects, options, refinement.build(cell).objects, {2, 64, 1})
      .missing;
}

TEST(CellPromise, HoldsBesideAWall) { EXPECT_EQ(missing_beside_a_wall(), 0U); }

// A wall so close to the cell that the near plane may clip it.
std::size_t missing_behind_a_clipped_wall() {
  const Hierarchy ball = build_hierarchy(test::noisy_sphere(3, 1));
  TriangleMesh mesh = test::grid(4, 4);
  for (glm::vec3& p : mesh.positions) p = {200.0F * p.x - 100.0F, 200.0F * p.y - 100.0F, 2.1F};
  const Hierarchy wall = build_hierarchy(mesh);
  const RefineObject objects[] = {{.hierarchy = &ball}, {.hierarchy = &wall}};
  const CellSurface surface(objects, 0.0);
  const CellOptions options{.eyes = tool::cube_eyes(128, 0.2)};
  const CellBox cell{{-0.05, -0.05, 2.2}, {0.05, 0.05, 2.4}};
  CellRefinement refinement(objects, &surface, nullptr, options);
  return tool::look_from(cell, tool::FullScene(objects), objects, options, refinement.build(cell).objects, {10, 64, 1})
      .missing;
}

TEST(CellPromise, HoldsBehindWhatIsClipped) { EXPECT_EQ(missing_behind_a_clipped_wall(), 0U); }

bool is_subset(const std::vector<SplitId>& inner, const std::vector<SplitId>& outer) {
  return std::includes(outer.begin(), outer.end(), inner.begin(), inner.end());
}

TEST(CellBuilder, CutsAreClosed) {
  const Hierarchy hierarchy = build_hierarchy(generate("city", {{"blocks", 2}, {"facade_cells", 4}}));
  const RefineObject objects[] = {{.hierarchy = &hierarchy}};
  const CellOccluders occluders(objects, 0.5);
  CellBuilder builder(objects, &occluders, {});
  const CellCut& cut = builder.build(around({60, 60, 1.7}, glm::dvec3(2)));
  const std::vector<SplitId>& applied = cut.objects[0].applied;
  ASSERT_GT(applied.size(), 100U);
  EXPECT_TRUE(std::is_sorted(applied.begin(), applied.end()));
  for (const SplitId s : applied)
    for (const SplitId needed : star_of(hierarchy, s).dependencies())
      EXPECT_TRUE(std::binary_search(applied.begin(), applied.end(), needed));
  EXPECT_EQ(cut.drawn_triangles, cut.objects[0].triangles.size());
  EXPECT_LT(cut.drawn_triangles, cut.triangles);
}

// More eyes see more: without occlusion, whose answers are conservative only.
TEST(CellBuilder, GrowsWithTheCell) {
  const Hierarchy hierarchy = build_hierarchy(generate("rough-planet", {{"level", 4}}));
  const RefineObject objects[] = {{.hierarchy = &hierarchy}};
  CellBuilder builder(objects, nullptr, {.tolerance_px = 20.0});
  std::vector<SplitId> inner;
  for (const double size : {0.0, 0.1, 0.5, 2.0}) {
    const std::vector<SplitId> outer = builder.build(around({0, 0, 2}, glm::dvec3(size))).objects[0].applied;
    EXPECT_TRUE(is_subset(inner, outer));
    EXPECT_GT(outer.size(), inner.size());
    inner = outer;
  }
}

// The base mesh where all errors are below the tolerance, all splits with an error where none is.
TEST(CellBuilder, TolerancesAtBothEnds) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(3, 5));
  const RefineObject objects[] = {{.hierarchy = &hierarchy}};
  const CellBox cell = around({0, 0, 3}, glm::dvec3(0.5));
  EXPECT_TRUE(CellBuilder(objects, nullptr, {.tolerance_px = 1e9}).build(cell).objects[0].applied.empty());
  EXPECT_EQ(CellBuilder(objects, nullptr, {.tolerance_px = 1e-6}).build(cell).triangles,
            hierarchy.input_triangle_count());
}

// A ball behind a wall is its base mesh, and not drawn; in front of it, it is.
TEST(CellBuilder, DropsWhatAWallHides) {
  const Hierarchy ball = build_hierarchy(test::noisy_sphere(4, 3));
  TriangleMesh mesh = test::grid(4, 4);
  for (glm::vec3& p : mesh.positions) p = {20.0F * p.x - 10.0F, 20.0F * p.y - 10.0F, 3.0F};
  const Hierarchy wall = build_hierarchy(mesh);
  const RefineObject objects[] = {{.hierarchy = &ball}, {.hierarchy = &wall}};
  const CellOccluders occluders(objects, 0.01);
  CellBuilder builder(objects, &occluders, {});
  const CellCut& hidden = builder.build(around({0, 0, 5}, glm::dvec3(1)));
  EXPECT_TRUE(hidden.objects[0].applied.empty());
  EXPECT_TRUE(hidden.objects[0].triangles.empty());
  EXPECT_FALSE(hidden.objects[1].triangles.empty());
  EXPECT_GT(builder.build(around({0, 0, 2}, glm::dvec3(0.5))).objects[0].applied.size(), 100U);
}

// Whatever was built before, and on whichever thread.
TEST(CellBuilder, CellsDoNotDependOnEachOther) {
  const CellScene scene = city();
  const Hierarchy hierarchy = build_hierarchy(scene.mesh);
  const RefineObject objects[] = {{.hierarchy = &hierarchy}};
  const CellOccluders occluders(objects, scene.max_motion);
  std::vector<CellObjectCut> alone(scene.cells.size()), together(scene.cells.size());
  for (std::size_t i = 0; i < scene.cells.size(); ++i)
    alone[i] = CellBuilder(objects, &occluders, {}).build(scene.cells[i]).objects[0];
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 2; ++t)
    threads.emplace_back([&, t] {
      CellBuilder builder(objects, &occluders, {});
      for (std::size_t i = scene.cells.size(); i-- > 0;)
        if (i % 2 == t) together[i] = builder.build(scene.cells[i]).objects[0];
    });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < scene.cells.size(); ++i) {
    EXPECT_EQ(alone[i].applied, together[i].applied);
    EXPECT_EQ(alone[i].triangles, together[i].triangles);
  }
}

// More splits fit into a larger budget, what is left is within error_px of what is seen, and a budget that is large
// enough gives what the tolerance takes.
TEST(CellBudget, IsNeverExceeded) {
  const CellScene scene = city();
  const Hierarchy hierarchy = build_hierarchy(scene.mesh);
  const RefineObject objects[] = {{.hierarchy = &hierarchy}};
  const CellOccluders occluders(objects, scene.max_motion);
  CellOptions options{.eyes = tool::cube_eyes(128, scene.near)};
  const CellBox& cell = scene.cells[0];
  const std::size_t without = CellBuilder(objects, &occluders, options).build(cell).triangles;
  double last = 1e300;
  int looked_at = 0;
  for (const std::size_t budget : {hierarchy.base_triangle_count(), without / 4, without / 2, without * 3 / 4}) {
    options.budget = budget;
    CellBuilder builder(objects, &occluders, options);
    const CellCut& cut = builder.build(cell);
    EXPECT_LE(cut.triangles, budget);
    EXPECT_GT(cut.triangles + 16, budget);  // a split that did not fit has few faces, with what it needs
    EXPECT_GT(cut.error_px, options.tolerance_px);
    EXPECT_LT(cut.error_px, last);
    last = cut.error_px;
    if (cut.error_px > 20.0) continue;  // the oracle is slow where all is near
    CellOptions reached = options;
    reached.tolerance_px = cut.error_px;
    ++looked_at;
    EXPECT_EQ(tool::look_from(cell, tool::FullScene(objects), objects, reached, cut.objects, {8, 64, 23}).missing, 0U);
  }
  EXPECT_GE(looked_at, 1);
  options.budget = 1'000'000;
  EXPECT_LE(CellBuilder(objects, &occluders, options).build(cell).error_px, options.tolerance_px);
}

// Each object is refined as far as its error on the screen asks for.
TEST(CellBudget, IsSharedByError) {
  const Hierarchy ball = build_hierarchy(test::noisy_sphere(4, 3));
  const RefineObject objects[] = {{&ball}, {&ball, glm::translate(glm::dmat4(1.0), {0, 0, -30})}};
  CellBuilder builder(objects, nullptr, {.budget = 600});
  const CellCut& cut = builder.build(around({0, 0, 3}, glm::dvec3(0.5)));
  EXPECT_LE(cut.triangles, 600U);
  EXPECT_GT(cut.objects[0].applied.size(), 2 * cut.objects[1].applied.size());
}

TEST(CellOcclusion, NoneHidesNothing) {
  const CellScene scene = city();
  const Hierarchy hierarchy = build_hierarchy(scene.mesh);
  const RefineObject objects[] = {{.hierarchy = &hierarchy}};
  const CellOccluders occluders(objects, scene.max_motion);
  CellBuilder none(objects, &occluders, {.occlusion = CellOcclusion::none}), without(objects, nullptr, {});
  const CellCut& cut = none.build(scene.cells[0]);
  EXPECT_EQ(cut.stats.queries, 0U);
  EXPECT_EQ(cut.objects[0].applied, without.build(scene.cells[0]).objects[0].applied);
}

// Slats with gaps between them hide a ball only together: the hull test keeps it, images drop it.
TEST(CellOcclusion, SampledDropsWhatAFenceHides) {
  const Hierarchy ball = build_hierarchy(test::noisy_sphere(4, 3));
  TriangleMesh mesh;
  for (int i = 0; i < 40; ++i) {  // two rows, so that no eye looks through
    TriangleMesh slat = test::grid(1, 1);
    for (glm::vec3& p : slat.positions) p = {0.6F * p.x - 0.3F, 8.0F * p.y - 4.0F, 0.0F};
    test::append(mesh, slat, {0.5F * static_cast<float>(i) - 10.0F, 0, i % 2 == 0 ? 3.0F : 2.99F});
  }
  const Hierarchy fence = build_hierarchy(mesh);
  const RefineObject objects[] = {{.hierarchy = &ball}, {&fence, glm::dmat4(1.0), true}};
  const CellOccluders occluders(objects, 0.001);
  CellOptions options{.eyes = tool::cube_eyes(128, 0.01)};
  const CellBox cell = around({0, 0, 4.5}, glm::dvec3(0.5));
  CellBuilder hull(objects, &occluders, options);
  options.occlusion = CellOcclusion::sampled;
  options.sampled_eyes = 2;
  CellBuilder sampled(objects, nullptr, options);
  EXPECT_GT(hull.build(cell).objects[0].triangles.size(), 100U);
  const CellCut& cut = sampled.build(cell);
  EXPECT_TRUE(cut.objects[0].triangles.empty());
  EXPECT_TRUE(cut.objects[0].applied.empty());
  EXPECT_GT(cut.objects[1].triangles.size(), 20U);
}

// Aggressive: little of what other eyes see is missing.
TEST(CellOcclusion, SampledMissesLittle) {
  const CellScene scene = city();
  const Hierarchy hierarchy = build_hierarchy(scene.mesh);
  const RefineObject objects[] = {{.hierarchy = &hierarchy}};
  CellOptions options{.eyes = tool::cube_eyes(256, scene.near), .sampled_eyes = 3};
  CellBuilder none(objects, nullptr, options);
  options.occlusion = CellOcclusion::sampled;
  CellBuilder sampled(objects, nullptr, options);
  std::size_t pixels = 0, missing = 0, drawn = 0, drawn_without = 0;
  for (const CellBox& cell : {scene.cells[0], scene.cells[3]}) {
    drawn_without += none.build(cell).drawn_triangles;
    const CellCut& cut = sampled.build(cell);
    drawn += cut.drawn_triangles;
    EXPECT_LE(cut.error_px, options.tolerance_px);
    const tool::CellSight sight =
        tool::look_from(cell, tool::FullScene(objects), objects, options, cut.objects, {20, 64, 23});
    pixels += sight.pixels;
    missing += sight.missing;
  }
  EXPECT_LT(2 * drawn, drawn_without);
  EXPECT_LT(missing * 200, pixels);
}

// Whatever was built before.
TEST(CellOcclusion, SampledCellsDoNotDependOnEachOther) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(4, 3));
  const RefineObject objects[] = {{.hierarchy = &hierarchy}};
  const CellOptions options{.eyes = tool::cube_eyes(64, 0.01), .occlusion = CellOcclusion::sampled, .sampled_eyes = 2};
  CellBuilder builder(objects, nullptr, options);
  const CellBox cell = around({0, 0, 2}, glm::dvec3(0.2));
  const std::vector<Triangle> first = builder.build(cell).objects[0].triangles;
  builder.build(around({0, 2, 0}, glm::dvec3(0.1)));
  EXPECT_EQ(builder.build(cell).objects[0].triangles, first);
  EXPECT_GT(first.size(), 50U);
}

TEST(CellBuilder, RefusesWhatMakesNoCut) {
  const Hierarchy hierarchy = build_hierarchy(test::tetrahedron());
  const RefineObject objects[] = {{.hierarchy = &hierarchy}}, missing[] = {{}};
  EXPECT_THROW(CellBuilder(objects, nullptr, {.tolerance_px = 0.0}), Error);
  EXPECT_THROW(CellBuilder(objects, nullptr, {.eyes = {.near = -1.0}}), Error);
  EXPECT_THROW(CellBuilder(objects, nullptr, {.budget = 1}), Error);
  EXPECT_THROW(CellBuilder(objects, nullptr, {.occlusion = CellOcclusion::sampled, .budget = 1'000}), Error);
  EXPECT_THROW(CellBuilder(objects, nullptr, {.occlusion = CellOcclusion::sampled, .sampled_eyes = 0}), Error);
  EXPECT_THROW(CellBuilder(missing, nullptr, {}), Error);
  EXPECT_THROW(CellOccluders(missing, 0.1), Error);
  EXPECT_THROW(CellOccluders(objects, -1.0), Error);
  EXPECT_THROW(CellBuilder(objects, nullptr, {}).build({glm::dvec3(1), glm::dvec3(0)}), Error);
}

TEST(CellOccludersInterface, Hides) {
  TriangleMesh mesh = test::grid(4, 4);
  for (glm::vec3& p : mesh.positions) p = {6.0F * p.x - 3.0F, 6.0F * p.y - 3.0F, 0.0F};
  const Hierarchy wall = build_hierarchy(mesh);
  const RefineObject objects[] = {{.hierarchy = &wall}};
  const CellOccluders occluders(objects, 0.01);
  EXPECT_LE(occluders.triangle_count(), 32U);
  const CellBox cell = around({0, 0, 5}, glm::dvec3(1));
  EXPECT_TRUE(occluders.hides(cell, around({0, 0, -5}, glm::dvec3(1))));
  EXPECT_FALSE(occluders.hides(cell, around({0, 0, -5}, glm::dvec3(1)), 5.0));
  EXPECT_FALSE(occluders.hides(cell, around({6, 0, -5}, glm::dvec3(1))));
}

}  // namespace
}  // namespace occlod
