// .olod files of meshes with seams, textures and materials: version 3.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "splits/hierarchy_data.h"
#include "support/meshes.h"
#include "support/wedge_meshes.h"

namespace occlod {
namespace {

class OlodWedges : public ::testing::Test {
 protected:
  OlodWedges() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(::testing::TempDir()) / (std::string("occlod_olod_wedges_") + test->name());
    std::filesystem::create_directories(folder_);
    mesh_ = test::grid_of_charts(
        24, [](int i, int j) { return (i / 5) * 5 + j / 5; }, [](int i, int) { return i / 12; });
    mesh_.materials[0] = {"stone \xff wall", {0.1F, 0.2F, 0.3F, 1.0F}, 1};
    mesh_.materials[1] = {"", {1.0F, 1.0F, 1.0F, 0.5F}, no_texture};
    mesh_.textures = {{"a b.png", "", {}, TextureWrap::clamp, TextureWrap::mirror}, {"", "image/png", {1, 2, 3, 255}}};
    mesh_.texture_origin = TextureOrigin::top_left;
    hierarchy_ = build_hierarchy(mesh_);
  }
  ~OlodWedges() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path write(const Hierarchy& hierarchy,
                                            OlodCompression compression = OlodCompression::none) const {
    write_olod(folder_ / "file.olod", hierarchy, {}, compression);
    return folder_ / "file.olod";
  }
  static std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  [[nodiscard]] std::string refusal(const std::string& bytes) const {
    std::ofstream(folder_ / "changed.olod", std::ios::binary) << bytes;
    try {
      read_olod(folder_ / "changed.olod").hierarchy.require_all();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  // Of a hierarchy that was changed.
  template <typename Change>
  [[nodiscard]] std::string refusal_after(const Change& change) const {
    HierarchyData data = copy_data(hierarchy_);
    change(data);
    return refusal(bytes_of(write(make_hierarchy(std::move(data)))));
  }

  std::filesystem::path folder_;
  TriangleMesh mesh_;
  Hierarchy hierarchy_;
};

TEST_F(OlodWedges, EveryCornerAndMaterialComesBack) {
  for (const OlodCompression compression : {OlodCompression::none, OlodCompression::zstd}) {
    const OlodFile file = read_olod(write(hierarchy_, compression));
    EXPECT_EQ(validate(file.hierarchy), std::vector<std::string>{});
    const TriangleMesh back = cut_mesh(file.hierarchy, full_cut(file.hierarchy));
    EXPECT_TRUE(test::sorted_corners_of(back) == test::sorted_corners_of(mesh_));
    EXPECT_EQ(back.textures, mesh_.textures);
    EXPECT_EQ(back.texture_origin, TextureOrigin::top_left);
    ASSERT_EQ(back.materials.size(), 2U);
    EXPECT_EQ(back.materials[0].base_color, mesh_.materials[0].base_color);
    EXPECT_EQ(back.materials[0].texture, 1U);
    EXPECT_EQ(back.materials[1], mesh_.materials[1]);
    for (SplitId s = 0; s < hierarchy_.split_count(); ++s)
      ASSERT_EQ(file.hierarchy.attribute_error(s), hierarchy_.attribute_error(s));
  }
}

TEST_F(OlodWedges, OnlyTheyNeedVersion3) {
  EXPECT_EQ(bytes_of(write(hierarchy_))[8], 3);
  const std::string plain = bytes_of(write(build_hierarchy(test::noisy_sphere(2, 1))));
  EXPECT_EQ(plain[8], 2);
  EXPECT_EQ(plain.find("WEDG"), std::string::npos);
  EXPECT_EQ(refusal(plain), "");
}

TEST_F(OlodWedges, EveryFlippedBitIsRefused) {
  // But for padding: less than 64 bytes before each of 19 sections, of some 60,000 bytes.
  const std::string good = bytes_of(write(hierarchy_));
  std::mt19937 random(3);
  int unseen = 0;
  for (int n = 0; n < 1500; ++n) {
    std::string bad = good;
    const std::size_t at = random() % bad.size();
    bad[at] = static_cast<char>(bad[at] ^ (1 << (random() % 8)));
    if (refusal(bad).empty()) ++unseen;
  }
  EXPECT_LT(unseen, 40);
}

TEST_F(OlodWedges, ConsistentChecksumsDoNotMakeWedges) {
  const auto expect_refused = [&](const char* words, const auto& change) {
    EXPECT_NE(refusal_after(change).find(words), std::string::npos) << words << "\n" << refusal_after(change);
  };
  EXPECT_EQ(refusal_after([](HierarchyData&) {}), "");
  expect_refused("wedge of another vertex", [](HierarchyData& d) { d.base_corners[0].x = 1 - d.base_corners[0].x; });
  expect_refused("is out of order", [](HierarchyData& d) { std::swap(d.extra_wedges.front(), d.extra_wedges.back()); });
  expect_refused("lies elsewhere", [](HierarchyData& d) { d.positions.back().x += 1.0F; });
  expect_refused("material that is not there", [](HierarchyData& d) { d.wedge_materials.back() = 7; });
  expect_refused("names texture", [](HierarchyData& d) { d.materials[0].texture = 9; });
  expect_refused("errors of attributes", [](HierarchyData& d) { d.attribute_errors.pop_back(); });
  expect_refused("texture coordinates", [](HierarchyData& d) { d.texture_coordinates.pop_back(); });
  expect_refused("do not fit the faces", [](HierarchyData& d) { d.base_corners.clear(); });
  expect_refused("leave their list", [](HierarchyData& d) { d.corner_starts[3] = 4'000'000'000U; });
  // Every word of the records: whatever is in them is refused or can be read safely.
  for (std::size_t i = 0; i < hierarchy_.data().corners.size(); i += 7)
    for (const std::uint32_t word : {0U, 0x7FFFFFFFU, 0xFFFFFFFFU}) {
      HierarchyData data = copy_data(hierarchy_);
      data.corners[i] = word;
      const auto problem = check_structure(view_of(data));
      if (problem) continue;
      const Hierarchy changed = make_hierarchy(std::move(data));
      for (const Triangle& t : wedge_triangles_of(changed, full_cut(changed)))
        for (int k = 0; k < 3; ++k) ASSERT_LT(t[k], changed.wedge_count());
    }
}

TEST_F(OlodWedges, DamagedMaterialsAreRefused) {
  const std::string good = bytes_of(write(hierarchy_));
  const std::size_t at = good.find("\"materials\"");
  ASSERT_NE(at, std::string::npos);
  std::string bad = good;
  bad[at + 1] = 'x';
  EXPECT_NE(refusal(bad), "");
}

}  // namespace
}  // namespace occlod
