// Cells and scenes that are made to be difficult.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "cell_sight.h"
#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "support/holed_meshes.h"
#include "support/meshes.h"

namespace occlod {
namespace {

CellBox around(const glm::dvec3& center, double half) { return {center - half, center + half}; }

struct Found {
  tool::CellSight sight;
  CellStats stats;
  double error_px = 0.0;
  std::size_t drawn = 0;
};

// `clip`: distance to the near plane.
Found look(std::span<const RefineObject> objects, const CellBox& cell, double max_motion, double clip,
           double tolerance_px = 1.0) {
  const CellOccluders occluders(objects, max_motion);
  const CellOptions options{.eyes = tool::cube_eyes(128, clip), .tolerance_px = tolerance_px};
  CellBuilder builder(objects, &occluders, options);
  const CellCut& cut = builder.build(cell);
  return {tool::look_from(cell, tool::FullScene(objects), objects, options, cut.objects, {12, 64, 23}), cut.stats,
          cut.error_px, cut.drawn_triangles};
}

TriangleMesh sheet_and_ball() {
  TriangleMesh mesh = test::sheet_with_windows();
  test::append(mesh, test::noisy_sphere(3, 4), {0, 0, -1.5F});
  return mesh;
}

void expect_all_drawn(const TriangleMesh& mesh, const CellBox& cell, double max_motion = 0.03) {
  const Hierarchy hierarchy = build_hierarchy(mesh);
  const RefineObject objects[] = {{&hierarchy, glm::dmat4(1.0), true}};
  const Found found = look(objects, cell, max_motion, 0.01);
  EXPECT_EQ(found.sight.missing, 0U);
  EXPECT_GT(found.sight.pixels, 1000U);
  EXPECT_LE(found.error_px, 1.0);
}

TEST(HardCells, GeometryInsideTheCell) { expect_all_drawn(sheet_and_ball(), around({0.1, 0, -0.5}, 0.8)); }
TEST(HardCells, EyesOnAWall) { expect_all_drawn(sheet_and_ball(), {{-0.2, -0.2, 0}, {0.2, 0.2, 0}}); }
TEST(HardCells, APoint) { expect_all_drawn(sheet_and_ball(), around({0.2, 0.1, 0.6}, 0.0)); }
TEST(HardCells, InsideASolid) { expect_all_drawn(test::noisy_sphere(4, 3), around({0, 0, 0}, 0.1)); }

// Two-sided, as what stands behind a hole shows its inside too.
TEST(HardCells, ThroughATunnel) {
  expect_all_drawn(test::block(true), around({0, 0, 1.5}, 0.1), 0.02);
  expect_all_drawn(test::block(true), around({0, 0, 1.5}, 0.1), 0.2);
}

// A wall with one window, and a ball behind it. Windows that are narrower than occluders may move stay open.
TEST(HardCells, AWindowOfAnyWidth) {
  for (const int cells : {9, 19, 79}) {  // the middle one is missing: 0.67, 0.32 and 0.076 wide
    TriangleMesh mesh = test::grid(cells, cells);
    for (glm::vec3& p : mesh.positions) p = {6.0F * p.x - 3.0F, 6.0F * p.y - 3.0F, 0.0F};
    const auto middle = static_cast<std::ptrdiff_t>(2 * (cells / 2 * cells + cells / 2));
    mesh.triangles.erase(mesh.triangles.begin() + middle, mesh.triangles.begin() + middle + 2);
    const Hierarchy wall = build_hierarchy(mesh), ball = build_hierarchy(test::noisy_sphere(4, 2));
    const RefineObject objects[] = {{&wall, glm::dmat4(1.0), true},
                                    {&ball, glm::translate(glm::dmat4(1.0), {0, 0, -2})}};
    const Found found = look(objects, around({0, 0, 2}, 0.2), 0.3, 0.01);
    EXPECT_EQ(found.sight.missing, 0U) << cells;
    EXPECT_GT(found.stats.queries_hidden, 0U) << cells;
  }
}

// At 1e9 rounding is allowed for by a unit.
TEST(HardCells, FarFromTheOrigin) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(4, 3));
  const glm::dvec3 place(1e9, -1e9, 1e9);
  const glm::dmat4 to_world = glm::scale(glm::translate(glm::dmat4(1.0), place), glm::dvec3(1e4));
  const RefineObject objects[] = {{.hierarchy = &hierarchy, .object_to_world = to_world}};
  const Found found = look(objects, around(place + glm::dvec3(0, 0, 2e4), 1e3), 100.0, 10.0);
  EXPECT_EQ(found.sight.missing, 0U);
  EXPECT_GT(found.stats.queries_hidden, 10U);
}

TEST(HardCells, FineAndCoarseTolerances) {
  const Hierarchy hierarchy = build_hierarchy(sheet_and_ball());
  const RefineObject objects[] = {{&hierarchy, glm::dmat4(1.0), true}};
  const CellBox cell = around({0, 0, 1}, 0.1);
  const Found fine = look(objects, cell, 0.03, 0.01, 0.01), coarse = look(objects, cell, 0.03, 0.01, 100.0);
  EXPECT_EQ(fine.sight.missing, 0U);
  EXPECT_EQ(coarse.sight.missing, 0U);
  EXPECT_GT(fine.drawn, coarse.drawn);
}

// Instances of one hierarchy are as the same geometry given once for each.
TEST(HardCells, Instances) {
  const Hierarchy ball = build_hierarchy(test::noisy_sphere(3, 3)), copy = build_hierarchy(test::noisy_sphere(3, 3));
  const auto at = [](double z, double size) {
    return glm::scale(glm::translate(glm::dmat4(1.0), {0.3 * z, 0, z}), glm::dvec3(size));
  };
  const RefineObject shared[] = {{&ball, at(0, 1)}, {&ball, at(-4, 1)}, {&ball, at(-8, 2)}};
  const RefineObject own[] = {{&ball, at(0, 1)}, {&copy, at(-4, 1)}, {&copy, at(-8, 2)}};
  const CellBox cell = around({0.5, 0, 3}, 0.2);
  const CellOccluders of_shared(shared, 0.02), of_own(own, 0.02);
  EXPECT_EQ(of_shared.triangle_count(), of_own.triangle_count());
  const CellCut a = CellBuilder(shared, &of_shared, {}).build(cell), b = CellBuilder(own, &of_own, {}).build(cell);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(a.objects[i].triangles, b.objects[i].triangles);
  EXPECT_GT(a.stats.queries_hidden, 10U);
  EXPECT_EQ(look(shared, cell, 0.02, 0.01).sight.missing, 0U);
}

}  // namespace
}  // namespace occlod
