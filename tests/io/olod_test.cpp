#include <gtest/gtest.h>
#include <xxhash.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <span>

#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "splits/hierarchy_data.h"
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
  // Opens the file and checks all of it.
  static std::string refusal(const std::filesystem::path& path) {
    try {
      read_olod(path).hierarchy.require_all();
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
bool same_bytes(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

TEST_F(OlodTest, ComesBackByteForByte) {
  for (const OlodCompression compression : {OlodCompression::none, OlodCompression::zstd}) {
    write_olod(folder_ / "good.olod", hierarchy_, report_, compression);
    const OlodFile file = read_olod(folder_ / "good.olod");
    const HierarchyView &a = hierarchy_.data(), &b = file.hierarchy.data();
    EXPECT_TRUE(same_bytes(a.positions, b.positions));
    EXPECT_TRUE(same_bytes(a.normals, b.normals));
    EXPECT_TRUE(same_bytes(a.colors, b.colors));
    EXPECT_TRUE(same_bytes(a.nodes, b.nodes));
    EXPECT_TRUE(same_bytes(a.stars, b.stars));
    EXPECT_TRUE(same_bytes(a.roots, b.roots));
    EXPECT_TRUE(same_bytes(a.base_faces, b.base_faces));
    EXPECT_EQ(a.face_count, b.face_count);
    EXPECT_EQ(a.error_bound, b.error_bound);
    EXPECT_EQ(file.compression, compression);
    EXPECT_EQ(file.report.vertices_read, 1234U);
    EXPECT_EQ(file.report.components, 3U);
    EXPECT_TRUE(validate(file.hierarchy).empty());
    EXPECT_TRUE(restores(file.hierarchy, mesh_));
    write_olod(folder_ / "again.olod", file.hierarchy, file.report, compression);
    EXPECT_EQ(bytes_of(folder_ / "again.olod"), bytes_of(folder_ / "good.olod"));
  }
}

TEST_F(OlodTest, ACopyIsSafeFromWhatHappensToTheFile) {
  // Of a mapped file the bytes that are cut off would be gone, and reading them end the program.
  const std::filesystem::path path = write_good();
  const OlodFile file = read_olod(path, OlodAccess::copied);
  std::filesystem::resize_file(path, 0);
  EXPECT_NO_THROW(file.hierarchy.require_all());
  EXPECT_TRUE(restores(file.hierarchy, mesh_));
  EXPECT_THROW((void)read_olod(path, OlodAccess::copied), Error);
  EXPECT_THROW((void)read_olod(folder_, OlodAccess::copied), Error);
  EXPECT_THROW((void)read_olod(folder_ / "missing.olod", OlodAccess::copied), Error);
}

TEST_F(OlodTest, CompressionMakesFilesSmaller) {
  write_olod(folder_ / "small.olod", hierarchy_, report_, OlodCompression::zstd);
  EXPECT_LT(std::filesystem::file_size(folder_ / "small.olod"), std::filesystem::file_size(write_good()) * 9 / 10);
}

// Constant normals pack a thousandfold, which no reader believes.
TEST_F(OlodTest, WhatCompressesTooWellIsStored) {
  TriangleMesh flat = test::grid(40, 40);
  flat.normals.assign(flat.vertex_count(), {0.0F, 0.0F, 1.0F});
  write_olod(folder_ / "flat.olod", build_hierarchy(flat), report_, OlodCompression::zstd);
  EXPECT_TRUE(restores(read_olod(folder_ / "flat.olod").hierarchy, flat));
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
  EXPECT_NE(refusal(write_bytes(good + "x")).find("truncated or has extra bytes"), std::string::npos);
}

TEST_F(OlodTest, EveryFlippedBitIsRefused) {
  // Only padding between sections, which nothing reads, may change unseen: less than 64 bytes before each of 10
  // sections, of some 40,000 bytes.
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
  HierarchyData data = copy_data(hierarchy_);
  data.nodes[20].child_u = 4'000'000'000U;
  write_olod(folder_ / "hostile.olod", make_hierarchy(std::move(data)), report_);
  EXPECT_NE(refusal(folder_ / "hostile.olod").find("do not form a valid hierarchy"), std::string::npos);
  data = copy_data(hierarchy_);
  data.base_faces[0].x = 4'000'000'000U;
  write_olod(folder_ / "hostile.olod", make_hierarchy(std::move(data)), report_);
  EXPECT_NE(refusal(folder_ / "hostile.olod").find("does not hold a valid hierarchy"), std::string::npos);
}

// Opening looks at the base mesh only; a block of splits is checked when one of them is first needed.
TEST_F(OlodTest, OnlyWhatIsUsedIsChecked) {
  const Hierarchy large = build_hierarchy(test::noisy_sphere(5, 1));
  ASSERT_GT(large.split_count(), 2 * SplitGuard::block_size);
  write_olod(folder_ / "large.olod", large, report_);
  std::string bytes = bytes_of(folder_ / "large.olod");
  const auto* last = reinterpret_cast<const char*>(&large.node(static_cast<SplitId>(large.split_count() - 1)));
  const std::size_t at = bytes.find(std::string(last, sizeof(SplitNode)));
  ASSERT_NE(at, std::string::npos);
  bytes[at] = static_cast<char>(~bytes[at]);
  const OlodFile file = read_olod(write_bytes(bytes));
  file.hierarchy.require(0);
  file.hierarchy.require(SplitGuard::block_size);
  EXPECT_THROW(file.hierarchy.require(static_cast<SplitId>(large.split_count() - 1)), Error);
  EXPECT_THROW(file.hierarchy.require_all(), Error);
}

// Sizes that lie are refused before memory is given to them, with checksums that are right.
TEST_F(OlodTest, ClaimsOfHugeSectionsAreRefused) {
  write_olod(folder_ / "small.olod", hierarchy_, report_, OlodCompression::zstd);
  const std::string good = bytes_of(folder_ / "small.olod");
  const auto with_claim = [&](std::size_t section, std::size_t field, std::uint64_t value) {
    std::string bad = good;
    std::uint32_t sections = 0;
    std::memcpy(&sections, &bad[12], sizeof(sections));
    std::memcpy(&bad[32 + 48 * section + field], &value, sizeof(value));
    const std::uint64_t checksum = XXH3_64bits(&bad[32], 48 * std::size_t{sections});
    std::memcpy(&bad[24], &checksum, sizeof(checksum));
    return refusal(write_bytes(bad));
  };
  constexpr std::uint64_t huge = std::uint64_t{3} << 60U;
  EXPECT_NE(with_claim(0, 8, huge).find("outside the file"), std::string::npos);             // where it starts
  EXPECT_NE(with_claim(0, 16, huge).find("outside the file"), std::string::npos);            // its bytes in the file
  EXPECT_NE(with_claim(0, 24, huge).find("after decompression"), std::string::npos);         // and decompressed
  EXPECT_NE(with_claim(0, 24, 12 * 100).find("cannot be decompressed"), std::string::npos);  // fewer than there are
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
