#include "occlod/viewcells/vlod_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "occlod/core/error.h"
#include "small_cells.h"

namespace occlod {
namespace {

class VlodFileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("vlod_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
    good_ = folder_ / "good.vlod";
    CellBuild(objects_, options_).write(good_, {.threads = 1});
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  test::SmallCells scene_;
  std::array<RefineObject, 3> objects_ = scene_.objects();
  CellTreeOptions options_ = test::SmallCells::options();
  std::filesystem::path folder_, good_;
};

TEST_F(VlodFileTest, HoldsWhatTheBuilderGives) {
  const auto file = open_vlod(good_, objects_);
  const CellTree& tree = file->tree();
  ASSERT_GT(tree.leaf_count(), 5U) << "some root cells are divided";
  const CellOccluders occluders(objects_, 0.01);
  CellBuilder builder(objects_, &occluders, options_.cell);
  std::size_t hidden = 0;
  for (CellId n = 0; n < tree.nodes().size(); ++n) {
    hidden += tree.node(n).hidden_faces;
    if (!tree.is_leaf(n)) continue;
    const CellCut& expected = builder.build(tree.node(n).box);
    const std::vector<CellObjectCut> cuts = read_cell(*file, objects_, n);
    ASSERT_EQ(cuts.size(), 3U);
    std::size_t drawn = 0;
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      EXPECT_EQ(cuts[i].applied, expected.objects[i].applied) << "cell " << n << ", object " << i;
      EXPECT_EQ(cuts[i].triangles, expected.objects[i].triangles) << "cell " << n << ", object " << i;
      drawn += cuts[i].triangles.size();
    }
    EXPECT_EQ(tree.node(n).drawn_triangles, drawn);
    EXPECT_EQ(tree.node(n).triangles, expected.triangles);
    EXPECT_EQ(tree.node(n).error_px, static_cast<float>(expected.error_px));
  }
  EXPECT_GT(hidden, 100U) << "or nothing is tested about hidden faces";
}

}  // namespace
}  // namespace occlod
