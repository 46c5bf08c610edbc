#include "occlod/io/ohlod.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>

#include "hlod/hlod_data.h"
#include "io/ohlod_format.h"
#include "occlod/core/error.h"
#include "occlod/hlod/build.h"
#include "occlod/hlod/validate.h"
#include "occlod/hlod/within.h"
#include "support/meshes.h"
#include "support/wedge_meshes.h"

namespace occlod {
namespace {

using hlod::Hlod;
using hlod::HlodData;

class OhlodTest : public ::testing::Test {
 protected:
  OhlodTest() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(::testing::TempDir()) / (std::string("occlod_ohlod_") + test->name());
    std::filesystem::create_directories(folder_);
    mesh_ = test::noisy_sphere(4, 1);
    for (const glm::vec3& p : mesh_.positions)
      mesh_.colors.emplace_back(glm::u8vec4(glm::vec4(p * 50.0F + 120.0F, 255.0F)));
    hlod::BuildOptions options;
    options.node_triangles = 64;
    hlod_ = build_hlod(mesh_, options);
    report_.vertices_read = 1234;
    report_.left_out.groups = 5;
  }
  ~OhlodTest() override { std::filesystem::remove_all(folder_); }

  // With splits.
  [[nodiscard]] Hlod refinable() const {
    hlod::BuildOptions options;
    options.node_triangles = 64;
    options.within = hlod::Within::splits;
    return build_hlod(mesh_, options);
  }
  [[nodiscard]] std::filesystem::path write_refinable() const {
    write_ohlod(folder_ / "refinable.ohlod", refinable(), report_);
    return folder_ / "refinable.ohlod";
  }
  [[nodiscard]] std::filesystem::path write_good() const {
    write_ohlod(folder_ / "good.ohlod", hlod_, report_);
    return folder_ / "good.ohlod";
  }
  static std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  [[nodiscard]] std::filesystem::path write_bytes(const std::string& bytes) const {
    const std::filesystem::path path = folder_ / "changed.ohlod";
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  // Opens the file and checks all of it.
  static std::string refusal(const std::filesystem::path& path) {
    try {
      read_ohlod(path).hlod.require_all();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  // Of a file with good checksums whose content has been changed.
  [[nodiscard]] std::string refusal_of_lie(const std::function<void(HlodData&)>& lie) const {
    return refusal_of_lie(hlod_, lie);
  }
  [[nodiscard]] std::string refusal_of_lie(const Hlod& of, const std::function<void(HlodData&)>& lie) const {
    HlodData data = copy_data(of);
    lie(data);
    write_ohlod(folder_ / "lie.ohlod", make_hlod(std::move(data)), report_);
    return refusal(folder_ / "lie.ohlod");
  }

  std::filesystem::path folder_;
  TriangleMesh mesh_;
  Hlod hlod_;
  MeshReport report_;
};

TEST_F(OhlodTest, TexturesMaterialsAndSeamsComeBack) {
  TriangleMesh mesh = test::grid_of_charts(
      24, [](int i, int) { return i / 12; }, [](int i, int) { return i / 12; });
  mesh.materials.resize(2);
  mesh.materials[0] = {"left", glm::vec4(1.0F, 0.5F, 0.25F, 1.0F), 1};
  mesh.textures.resize(2);
  mesh.textures[0].file = "bark.png";
  mesh.textures[1] = {"", "image/png", {1, 2, 3}, TextureWrap::clamp, TextureWrap::mirror};
  mesh.texture_origin = TextureOrigin::top_left;
  hlod::BuildOptions options;
  options.node_triangles = 64;
  options.within = hlod::Within::splits;
  const Hlod built = build_hlod(mesh, options);
  const std::filesystem::path file = folder_ / "textured.ohlod";
  write_ohlod(file, built, report_);
  EXPECT_EQ(bytes_of(file)[8], 2) << "version";
  for (const OlodAccess access : {OlodAccess::mapped, OlodAccess::copied}) {
    const Hlod read = read_ohlod(file, access).hlod;
    EXPECT_EQ(hlod::validate(read), std::vector<std::string>{});
    EXPECT_TRUE(restores(read, mesh));
    EXPECT_TRUE(read.data().has_seams);
    EXPECT_TRUE(std::ranges::equal(read.data().meshes, built.data().meshes));
    EXPECT_TRUE(std::ranges::equal(read.data().splits, built.data().splits));
    EXPECT_TRUE(std::ranges::equal(read.data().materials, mesh.materials));
    EXPECT_TRUE(std::ranges::equal(read.data().textures, mesh.textures));
    EXPECT_EQ(read.data().texture_origin, TextureOrigin::top_left);
  }
}

TEST_F(OhlodTest, FilesWithoutTexturesAreOfVersionOne) { EXPECT_EQ(bytes_of(write_good())[8], 1); }

TEST_F(OhlodTest, ComesBackByteForByte) {
  for (const OlodAccess access : {OlodAccess::mapped, OlodAccess::copied}) {
    const OhlodFile file = read_ohlod(write_good(), access);
    EXPECT_TRUE(validate(file.hlod).empty());
    EXPECT_TRUE(restores(file.hlod, mesh_));
    EXPECT_EQ(file.report.vertices_read, 1234U);
    EXPECT_EQ(file.report.left_out.groups, 5U);
    EXPECT_EQ(file.hlod.data().node_triangles, 64U);
    EXPECT_TRUE(file.hlod.data().has_colors);
    EXPECT_FALSE(file.hlod.data().has_normals);
    write_ohlod(folder_ / "again.ohlod", file.hlod, file.report);
    EXPECT_EQ(bytes_of(folder_ / "again.ohlod"), bytes_of(folder_ / "good.ohlod"));
  }
}

TEST_F(OhlodTest, KindsComeBack) {
  hlod::BuildOptions options;
  options.node_triangles = 64;
  options.grouping = hlod::Grouping::nested;
  options.borders = hlod::Borders::free;
  write_ohlod(folder_ / "nested.ohlod", build_hlod(mesh_, options), report_);
  const OhlodFile file = read_ohlod(folder_ / "nested.ohlod");
  EXPECT_EQ(file.hlod.data().grouping, hlod::Grouping::nested);
  EXPECT_EQ(file.hlod.data().borders, hlod::Borders::free);
  EXPECT_TRUE(validate(file.hlod).empty());
}

TEST_F(OhlodTest, SplitsComeBackAndAreNotThereWithoutThem) {
  const std::string plain = bytes_of(write_good()), refinable = bytes_of(write_refinable());
  for (const char* section : {"WNOD", "WSPL", "WBLK"}) {
    EXPECT_EQ(plain.find(section), std::string::npos);
    EXPECT_NE(refinable.find(section), std::string::npos);
  }
  EXPECT_FALSE(read_ohlod(folder_ / "good.ohlod").hlod.has_within(0));
  for (const OlodAccess access : {OlodAccess::mapped, OlodAccess::copied}) {
    const OhlodFile file = read_ohlod(folder_ / "refinable.ohlod", access);
    EXPECT_TRUE(file.hlod.has_within(0));
    EXPECT_TRUE(validate(file.hlod).empty());
    write_ohlod(folder_ / "again.ohlod", file.hlod, file.report);
    EXPECT_EQ(bytes_of(folder_ / "again.ohlod"), refinable);
  }
}

TEST_F(OhlodTest, DamagedSplitsAreFoundWhenTheyAreUsed) {
  std::string bad = bytes_of(write_refinable());
  std::uint64_t offset = 0;
  std::memcpy(&offset, bad.data() + bad.find("WSPL") + 8, sizeof(offset));
  bad[offset] = static_cast<char>(bad[offset] ^ 1);
  const OhlodFile file = read_ohlod(write_bytes(bad));
  EXPECT_NO_THROW(file.hlod.require(0)) << "its mesh is as it was";
  EXPECT_NO_THROW(file.hlod.require_within(1));
  EXPECT_THROW(file.hlod.require_within(0), Error);
  EXPECT_THROW(file.hlod.require_within(0), Error) << "and again";
  EXPECT_THROW((void)within_cut(file.hlod, 0, 0.0), Error);
  EXPECT_NE(refusal(folder_ / "changed.ohlod").find("splits of node 0: are damaged: their checksum is wrong"),
            std::string::npos);
}

TEST_F(OhlodTest, LiesAboutSplitsAreRefused) {
  const Hlod good = refinable();
  EXPECT_EQ(refusal_of_lie(good, [](HlodData&) {}), "");
  EXPECT_NE(refusal_of_lie(good, [](HlodData& d) { d.within[0].splits = 60'000; }).find("valid HLOD"),
            std::string::npos);
  EXPECT_NE(refusal_of_lie(good, [](HlodData& d) { d.within[0].place += 4; }).find("valid HLOD"), std::string::npos);
  EXPECT_NE(refusal_of_lie(good,
                           [](HlodData& d) {
                             const hlod::SplitsLayout layout(d.within[0], {.colors = true});
                             d.splits[d.within[0].place + layout.parents + 1] = std::byte{0x7f};
                           })
                .find("splits of node 0: are not valid: a split comes before one that it needs"),
            std::string::npos);
}

TEST_F(OhlodTest, EveryTruncationIsRefused) {
  for (const std::string& good : {bytes_of(write_good()), bytes_of(write_refinable())}) {
    for (std::size_t size = 0; size < good.size(); size += size < 700 ? 1 : 509)
      EXPECT_NE(refusal(write_bytes(good.substr(0, size))), "") << size << " bytes";
    EXPECT_NE(refusal(write_bytes(good + "x")).find("truncated or has extra bytes"), std::string::npos);
  }
}

TEST_F(OhlodTest, EveryFlippedBitIsRefused) {
  // But for padding between sections, which nothing reads: less than 64 bytes before each of 11 sections, or 14.
  for (const std::string& good : {bytes_of(write_good()), bytes_of(write_refinable())}) {
    std::mt19937 random(3);
    int unseen = 0;
    for (int n = 0; n < 1000; ++n) {
      std::string bad = good;
      const std::size_t at = n < 700 ? static_cast<std::size_t>(n) : random() % bad.size();
      bad[at] = static_cast<char>(bad[at] ^ (1 << (random() % 8)));
      if (refusal(write_bytes(bad)).empty()) ++unseen;
    }
    EXPECT_LT(unseen, 80);
  }
}

TEST_F(OhlodTest, SaysWhatIsWrong) {
  const std::string good = bytes_of(write_good());
  EXPECT_NE(refusal(folder_ / "missing.ohlod").find("cannot be opened"), std::string::npos);
  EXPECT_NE(refusal(folder_).find("cannot be opened"), std::string::npos);
  EXPECT_NE(refusal(write_bytes("ply\n")).find("is not an .ohlod file; make one with 'occlod hlod build'"),
            std::string::npos);
  std::string other_version = good;
  other_version[8] = 77;
  EXPECT_NE(refusal(write_bytes(other_version)).find("version 77"), std::string::npos);
  std::string damaged = good;
  damaged[good.size() / 2] = static_cast<char>(damaged[good.size() / 2] ^ 1);  // most of the file are meshes
  EXPECT_NE(refusal(write_bytes(damaged)).find("checksum is wrong; build it again with 'occlod hlod build'"),
            std::string::npos);
  for (const std::string& line : {refusal(write_bytes(damaged)), refusal(write_bytes(other_version))}) {
    EXPECT_EQ(line.find('\n'), std::string::npos);
    EXPECT_NE(line.find("changed.ohlod"), std::string::npos);
  }
}

TEST_F(OhlodTest, DamageIsFoundWhenTheNodeIsUsed) {
  std::string bad = bytes_of(write_good());
  std::uint64_t offset = 0;
  std::memcpy(&offset, bad.data() + bad.find("MESH") + 8, sizeof(offset));
  bad[offset] = static_cast<char>(bad[offset] ^ 1);
  const OhlodFile file = read_ohlod(write_bytes(bad));
  EXPECT_NO_THROW(file.hlod.require(5));
  EXPECT_THROW(file.hlod.require(0), Error);
  EXPECT_THROW(file.hlod.require(0), Error) << "and again";
  EXPECT_THROW((void)validate(file.hlod), Error);
}

TEST_F(OhlodTest, LiesWithGoodChecksumsAreRefused) {
  EXPECT_EQ(refusal_of_lie([](HlodData&) {}), "");
  EXPECT_NE(refusal_of_lie([](HlodData& d) { d.nodes[3].vertices -= 1; }), "");
  EXPECT_NE(refusal_of_lie([](HlodData& d) { d.patches[3].parent = no_id - 1; }).find("valid HLOD"), std::string::npos);
  EXPECT_NE(refusal_of_lie([](HlodData& d) { d.input_triangle_count = 1; }).find("valid HLOD"), std::string::npos);
  EXPECT_NE(refusal_of_lie([](HlodData& d) { d.levels.clear(); }).find("valid HLOD"), std::string::npos);
  EXPECT_NE(refusal_of_lie([](HlodData& d) { d.children[0] = no_id; }).find("valid HLOD"), std::string::npos);
  EXPECT_NE(refusal_of_lie([](HlodData& d) {
              const hlod::MeshLayout layout(d.nodes[4], {.colors = true});
              d.meshes[d.nodes[4].mesh + layout.indices + 1] = std::byte{0x7f};
            }).find("node 4: has no valid mesh: an index is out of range"),
            std::string::npos);
}

}  // namespace
}  // namespace occlod
