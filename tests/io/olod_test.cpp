#include "occlod/io/olod.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "occlod/core/error.h"
#include "occlod/hierarchy/build.h"
#include "occlod/hierarchy/validate.h"
#include "support/meshes.h"

namespace occlod {
namespace {

class OlodTest : public ::testing::Test {
 protected:
  OlodTest() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(::testing::TempDir()) / (std::string("occlod_olod_") + test->name());
    std::filesystem::create_directories(folder_);
    mesh_ = test::noisy_sphere(2, 1);
    for (const glm::vec3& p : mesh_.positions)
      mesh_.colors.emplace_back(glm::u8vec4(glm::vec4(p * 100.0F + 120.0F, 255.0F)));
    hierarchy_ = build_hierarchy(mesh_);
    report_.vertices_read = 1234;
    report_.components = 3;
  }
  ~OlodTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path write_good() const {
    write_olod(folder_ / "good.olod", hierarchy_, report_);
    return folder_ / "good.olod";
  }
  static std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  [[nodiscard]] std::filesystem::path write_bytes(const std::string& bytes) const {
    const std::filesystem::path path = folder_ / "changed.olod";
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  static std::string refusal(const std::filesystem::path& path) {
    try {
      (void)read_olod(path);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
  TriangleMesh mesh_;
  Hierarchy hierarchy_;
  MeshReport report_;
};

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

TEST_F(OlodTest, ComesBackByteForByte) {
  const OlodFile file = read_olod(write_good());
  const HierarchyData &a = hierarchy_.data(), &b = file.hierarchy.data();
  EXPECT_TRUE(same_bytes(a.positions, b.positions));
  EXPECT_TRUE(same_bytes(a.normals, b.normals));
  EXPECT_TRUE(same_bytes(a.colors, b.colors));
  EXPECT_TRUE(same_bytes(a.nodes, b.nodes));
  EXPECT_TRUE(same_bytes(a.roots, b.roots));
  EXPECT_TRUE(same_bytes(a.first_dependency, b.first_dependency));
  EXPECT_TRUE(same_bytes(a.dependencies, b.dependencies));
  EXPECT_TRUE(same_bytes(a.faces, b.faces));
  EXPECT_TRUE(same_bytes(a.died, b.died));
  EXPECT_TRUE(same_bytes(a.removed_faces, b.removed_faces));
  EXPECT_TRUE(same_bytes(a.boxes, b.boxes));
  EXPECT_TRUE(same_bytes(a.cylinders, b.cylinders));
  EXPECT_EQ(file.report.vertices_read, 1234U);
  EXPECT_EQ(file.report.components, 3U);
  EXPECT_TRUE(validate(file.hierarchy).empty());
  EXPECT_TRUE(restores(file.hierarchy, mesh_));
  write_olod(folder_ / "again.olod", file.hierarchy, file.report);
  EXPECT_EQ(bytes_of(folder_ / "again.olod"), bytes_of(folder_ / "good.olod"));
}

TEST_F(OlodTest, HierarchyWithoutSplitsIsAFileToo) {
  const Hierarchy small = build_hierarchy(test::single_triangle());
  ASSERT_EQ(small.split_count(), 0U);
  write_olod(folder_ / "small.olod", small, {});
  EXPECT_EQ(read_olod(folder_ / "small.olod").hierarchy.base_triangle_count(), 1U);
}

TEST_F(OlodTest, EveryTruncationIsRefused) {
  const std::string good = bytes_of(write_good());
  for (std::size_t size = 0; size < good.size(); size += size < 600 ? 1 : 509)
    EXPECT_NE(refusal(write_bytes(good.substr(0, size))), "") << size << " bytes";
  EXPECT_NE(refusal(write_bytes(good + "x")).find("cut or added to"), std::string::npos);
}

TEST_F(OlodTest, EveryFlippedBitIsRefused) {
  // Only padding between sections, which nothing reads, may change unseen: less than 64 bytes before each of 13
  // sections.
  const std::string good = bytes_of(write_good());
  std::mt19937 random(3);
  int unseen = 0;
  for (int n = 0; n < 800; ++n) {
    std::string bad = good;
    const std::size_t at = n < 500 ? static_cast<std::size_t>(n) : random() % bad.size();
    bad[at] = static_cast<char>(bad[at] ^ (1 << (random() % 8)));
    if (refusal(write_bytes(bad)).empty()) ++unseen;
  }
  EXPECT_LT(unseen, 80);
}

TEST_F(OlodTest, SaysWhatIsWrong) {
  const std::string good = bytes_of(write_good());
  EXPECT_NE(refusal(folder_ / "missing.olod").find("cannot be opened"), std::string::npos);
  EXPECT_NE(refusal(folder_).find("cannot be opened"), std::string::npos);
  EXPECT_NE(refusal(write_bytes("ply\n")).find("not an .olod file"), std::string::npos);
  std::string other_version = good;
  other_version[8] = 77;
  EXPECT_NE(refusal(write_bytes(other_version)).find("version 77"), std::string::npos);
  std::string damaged = good;
  damaged[damaged.size() / 2] = static_cast<char>(~damaged[damaged.size() / 2]);
  EXPECT_NE(refusal(write_bytes(damaged)).find("checksum"), std::string::npos);
}

TEST_F(OlodTest, ConsistentChecksumsDoNotMakeAHierarchy) {
  // A hostile file can have right checksums: the structure is checked as well.
  HierarchyData data = hierarchy_.data();
  data.nodes[20].child_u = 4'000'000'000U;
  write_olod(folder_ / "hostile.olod", Hierarchy(std::move(data)), report_);
  EXPECT_NE(refusal(folder_ / "hostile.olod").find("holds no hierarchy"), std::string::npos);
}

TEST_F(OlodTest, FailedWriteLeavesTheOldFile) {
  const std::string before = bytes_of(write_good());
  EXPECT_THROW(write_olod(folder_ / "no_such_folder" / "x.olod", hierarchy_, report_), Error);
  std::filesystem::create_directory(folder_ / "folder.olod");
  EXPECT_THROW(write_olod(folder_ / "folder.olod", hierarchy_, report_), Error);
  EXPECT_EQ(bytes_of(folder_ / "good.olod"), before);
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder_)) ++files;
  EXPECT_EQ(files, 2U);  // good.olod and the folder: nothing temporary is left
}

}  // namespace
}  // namespace occlod
