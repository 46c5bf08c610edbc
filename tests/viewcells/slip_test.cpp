// Cells whose textures slip: on a sheet that is flat any cut is the surface itself, and only its texture coordinates
// can be off.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <string>
#include <vector>

#include "cells/cell_geometry.h"
#include "occlod/base.h"
#include "occlod/build_cells.h"
#include "occlod/build_hierarchy.h"
#include "occlod/cell_walker.h"
#include "small_cells.h"
#include "splits/star.h"
#include "support/wedge_meshes.h"

namespace occlod {
namespace {

// By how far a texel is away from where a plain texture would have it.
glm::vec2 waves(const glm::vec2& p) {
  return 0.03F * glm::vec2(std::sin(11.0F * p.x) * std::cos(8.0F * p.y), std::cos(9.0F * p.x) * std::sin(10.0F * p.y));
}

TriangleMesh wavy_texture() {
  TriangleMesh sheet = test::grid_of_charts(
      32, [](int, int) { return 0; }, [](int, int) { return 0; });
  for (glm::vec2& uv : sheet.texture_coordinates) uv += waves(uv);
  return sheet;
}

// Root mean square over the sheet of how far the cut shows a texel from where the input does. Texture coordinates are
// lengths on the sheet, but for the waves.
double slip(const Hierarchy& hierarchy, const std::vector<SplitId>& applied) {
  FixedCut cut;
  cut.applied.resize(hierarchy.split_count());
  for (const SplitId s : applied) cut.applied[s] = true;
  const TriangleMesh mesh = cut_mesh(hierarchy, cut);
  double sum = 0.0;
  int count = 0;
  for (int j = 0; j < 32; ++j)
    for (int i = 0; i < 32; ++i) {  // at vertices of the input, where it has no error of its own
      const glm::vec2 p = glm::vec2(i, j) / 32.0F;
      for (const Triangle& t : mesh.triangles) {
        const glm::vec2 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        const glm::mat2 edges(b - a, c - a);
        if (glm::determinant(edges) == 0.0F) continue;
        const glm::vec2 at = glm::inverse(edges) * (p - a);
        if (at.x < -1e-5F || at.y < -1e-5F || at.x + at.y > 1.0F + 1e-5F) continue;
        const auto& uv = mesh.texture_coordinates;
        const glm::vec2 shown = (1.0F - at.x - at.y) * uv[t.x] + at.x * uv[t.y] + at.y * uv[t.z];
        const glm::vec2 off = shown - (p + waves(p));
        sum += static_cast<double>(glm::dot(off, off));
        ++count;
        break;
      }
    }
  EXPECT_EQ(count, 32 * 32) << "the cut covers the sheet";
  return std::sqrt(sum / count);
}

class CellSlip : public testing::Test {
 protected:
  [[nodiscard]] static CellOptions options(CellOcclusion occlusion) {
    CellOptions options;
    options.eyes.focal_length_px = 300.0;
    options.tolerance_px = 1.5;
    options.occlusion = occlusion;
    options.sampled_eyes = 2;
    return options;
  }
  [[nodiscard]] CellCut cut(const CellOptions& options, bool attributes) const {
    const RefineObject objects[] = {{.hierarchy = &sheet_, .two_sided = true, .attributes = attributes}};
    const CellOccluders occluders(objects, 0.0);
    return CellBuilder(objects, &occluders, options).build(cell_);
  }

  Hierarchy sheet_ = build_hierarchy(wavy_texture(), {.base_triangles = 2});
  CellBox cell_{{0.4, 0.4, 0.7}, {0.6, 0.6, 0.8}};  // above its middle
};

// However what is hidden is found: nothing is.
TEST_F(CellSlip, IsWithinTheTolerance) {
  for (const CellOcclusion occlusion : {CellOcclusion::none, CellOcclusion::hull, CellOcclusion::sampled}) {
    const CellOptions tolerance = options(occlusion);
    const CellCut without = cut(tolerance, false), with = cut(tolerance, true);
    // The surface is exact, but guaranteed errors count what rounding may add, collapse by collapse.
    EXPECT_LT(without.triangles, 20U);
    EXPECT_LT(without.error_px, 0.2 * tolerance.tolerance_px);
    EXPECT_GT(with.triangles, 10 * without.triangles);
    EXPECT_LT(with.triangles, sheet_.input_triangle_count()) << "or the tolerance does not count";
    EXPECT_GT(with.error_px, 0.5 * tolerance.tolerance_px);
    EXPECT_LE(with.error_px, tolerance.tolerance_px);
    // Errors are saturated and boxes hold what is below them, so this holds split by split.
    const CellView view(cell_, tolerance.eyes, glm::dmat4(1.0));
    for (SplitId s = 0; s < sheet_.split_count(); ++s) {
      if (std::ranges::binary_search(with.objects[0].applied, s)) continue;
      const float scale = view.largest_scale_px(box_of(star_of(sheet_, s), sheet_.positions()));
      EXPECT_LE(sheet_.attribute_error(s) * scale, 1.001 * tolerance.tolerance_px) << s;
    }
    // And it is what shows: every point of the sheet is 0.7 to 1.4 away from the eyes.
    const double focal = tolerance.eyes.focal_length_px;
    EXPECT_LT(slip(sheet_, with.objects[0].applied) * focal / 0.7, tolerance.tolerance_px);
    EXPECT_GT(slip(sheet_, without.objects[0].applied) * focal / 1.4, 2.0 * tolerance.tolerance_px);
  }
}

// What a budget buys, and what is left. Without attributes there is nothing to buy.
TEST_F(CellSlip, IsWhatABudgetReduces) {
  CellOptions some = options(CellOcclusion::none);
  some.tolerance_px = 1e-3;
  EXPECT_LT(cut(options(CellOcclusion::none), false).triangles, 20U);
  double before = 1e9;
  for (const std::size_t budget : {100U, 400U, 1600U}) {
    some.budget = budget;
    const CellCut found = cut(some, true);
    EXPECT_LE(found.triangles, budget);
    EXPECT_GT(found.triangles, budget - 20);
    EXPECT_LT(found.error_px, 0.6 * before);
    before = found.error_px;
    const CellView view(cell_, some.eyes, glm::dmat4(1.0));
    for (SplitId s = 0; s < sheet_.split_count(); ++s) {
      if (std::ranges::binary_search(found.objects[0].applied, s)) continue;
      const float scale = view.largest_scale_px(box_of(star_of(sheet_, s), sheet_.positions()));
      EXPECT_LE(sheet_.attribute_error(s) * scale, 1.001 * found.error_px) << s;
    }
  }
}

class CellSlipFiles : public CellSlip {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "occlod-slip-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::vector<RefineObject> objects(bool attributes) const {
    return {{.hierarchy = &sheet_, .two_sided = true, .attributes = attributes}};
  }
  [[nodiscard]] CellTreeOptions tree_options() const {
    CellTreeOptions tree;
    tree.cell = options(CellOcclusion::none);
    tree.regions = {{{0.0, 0.4, 0.3}, {1.0, 0.6, 0.5}}};
    tree.root_cell = 0.25;
    return tree;
  }
  std::filesystem::path folder_;
};

// In frames that are late: the walker adds up what the splits leave that it does not have, and so does a packed file.
TEST_F(CellSlipFiles, IsAnErrorOfCoarseFrames) {
  for (const bool attributes : {false, true}) {
    const auto placed = objects(attributes);
    CellBuild(placed, tree_options()).write(folder_ / "cells.vlod", 1);
    const auto file = open_vlod(folder_ / "cells.vlod", placed);
    pack_cells(*file, placed, folder_ / "packed.vlod");
    WalkOptions options;
    options.loaders = 0;
    CellWalker walker(file, placed, options), packed(open_vlod(folder_ / "packed.vlod"), options);
    const glm::dvec3 eye(0.1, 0.5, 0.4);
    for (CellWalker* const through : {&walker, &packed}) {
      const WalkedFrame& late = through->step(eye, 1.0 / 60.0);
      ASSERT_TRUE(late.late);
      if (attributes) {
        EXPECT_GT(late.error_px, 1.5 * tree_options().cell.tolerance_px);
      } else {
        EXPECT_LT(late.error_px, 0.5 * tree_options().cell.tolerance_px);
      }
      CellLoader loader(*through);
      while (loader.begin()) loader.finish();
      const WalkedFrame& there = through->step(eye, 1.0 / 60.0);
      ASSERT_FALSE(there.late);
      EXPECT_LE(there.error_px, tree_options().cell.tolerance_px);
      EXPECT_EQ(there.drawn_triangles > 100, attributes);
    }
  }
}

// Files say whether attributes counted, and are refused where that has changed.
TEST_F(CellSlipFiles, IsPartOfTheScene) {
  const auto with = objects(true), without = objects(false);
  CellBuild(with, tree_options()).write(folder_ / "with.vlod", 1);
  CellBuild(without, tree_options()).write(folder_ / "without.vlod", 1);
  EXPECT_NE(open_vlod(folder_ / "with.vlod")->key(), open_vlod(folder_ / "without.vlod")->key());
  static_cast<void>(open_vlod(folder_ / "with.vlod", with));
  static_cast<void>(open_vlod(folder_ / "without.vlod", without));
  for (const bool attributes : {false, true}) try {
      static_cast<void>(open_vlod(folder_ / (attributes ? "without.vlod" : "with.vlod"), objects(attributes)));
      ADD_FAILURE() << "opened with other attributes";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("object 0: has had 'attributes' turned on or off"), std::string::npos)
          << error.what();
    }
}

// The same bytes where there is nothing that could slip.
TEST_F(CellSlipFiles, ConcernsMeshesWithAttributesOnly) {
  const test::SmallCells small;
  auto placed = small.objects();
  CellBuild(placed, test::SmallCells::options()).write(folder_ / "with.vlod", 1);
  for (RefineObject& object : placed) object.attributes = false;
  CellBuild(placed, test::SmallCells::options()).write(folder_ / "without.vlod", 1);
  EXPECT_EQ(test::bytes_of_file(folder_ / "with.vlod"), test::bytes_of_file(folder_ / "without.vlod"));
}

}  // namespace
}  // namespace occlod
