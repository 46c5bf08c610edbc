#include "hlod/store/ohlod.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <thread>

#include "fuzz/section_signer.h"
#include "hlod/store/hlod_data.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/hlod.h"
#include "occlod/node_store.h"
#include "support/meshes.h"
#include "support/wedge_meshes.h"

namespace occlod {
namespace {

using hlod::Hlod;
using hlod::HlodData;

class OhlodFixture {
 protected:
  explicit OhlodFixture(OlodCompression compression) : compression_(compression) {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("occlod_ohlod_") + test->name();
    std::ranges::replace(name, '/', '_');
    folder_ = std::filesystem::path(::testing::TempDir()) / name;
    std::filesystem::create_directories(folder_);
    mesh_ = test::noisy_sphere(4, 1);
    for (const glm::vec3& p : mesh_.positions)
      mesh_.colors.emplace_back(glm::u8vec4(glm::vec4(p * 50.0F + 120.0F, 255.0F)));
    hlod::HlodBuildOptions options;
    options.node_triangles = 64;
    hlod_ = build_hlod(mesh_, options);
    report_.vertices_read = 1234;
    report_.left_out.add("groups", 5);
  }
  ~OhlodFixture() { std::filesystem::remove_all(folder_); }
  OhlodFixture(const OhlodFixture&) = delete;
  OhlodFixture& operator=(const OhlodFixture&) = delete;

  void write(const std::filesystem::path& path, const Hlod& hlod) const {
    write_ohlod(path, hlod, report_, {.compression = compression_});
  }
  [[nodiscard]] bool is_packed() const { return compression_ != OlodCompression::none; }

  // With splits.
  [[nodiscard]] Hlod refinable() const {
    hlod::HlodBuildOptions options;
    options.node_triangles = 64;
    options.within = hlod::Within::splits;
    return build_hlod(mesh_, options);
  }
  [[nodiscard]] std::filesystem::path write_refinable() const {
    write(folder_ / "refinable.ohlod", refinable());
    return folder_ / "refinable.ohlod";
  }
  [[nodiscard]] std::filesystem::path write_good() const {
    write(folder_ / "good.ohlod", hlod_);
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
    write(folder_ / "lie.ohlod", make_hlod(std::move(data)));
    return refusal(folder_ / "lie.ohlod");
  }

  OlodCompression compression_;
  std::filesystem::path folder_;
  TriangleMesh mesh_;
  Hlod hlod_;
  MeshReport report_;
};

class OhlodTest : public OhlodFixture, public ::testing::TestWithParam<OlodCompression> {
 protected:
  OhlodTest() : OhlodFixture(GetParam()) {}
};

INSTANTIATE_TEST_SUITE_P(Of, OhlodTest, ::testing::Values(OlodCompression::none, OlodCompression::zstd),
                         [](const auto& of) { return of.param == OlodCompression::none ? "stored" : "packed"; });

// Of files whose arrays are as they are in memory.
class StoredOhlodTest : public OhlodFixture, public ::testing::Test {
 protected:
  StoredOhlodTest() : OhlodFixture(OlodCompression::none) {}
};

TEST_P(OhlodTest, TexturesMaterialsAndSeamsComeBack) {
  TriangleMesh mesh = test::grid_of_charts(
      24, [](int i, int) { return i / 12; }, [](int i, int) { return i / 12; });
  mesh.materials.resize(2);
  mesh.materials[0] = {"left", glm::vec4(1.0F, 0.5F, 0.25F, 1.0F), 1};
  mesh.textures.resize(2);
  mesh.textures[0].file = "bark.png";
  mesh.textures[1] = {"", "image/png", {1, 2, 3}, TextureWrap::clamp, TextureWrap::mirror};
  mesh.texture_origin = TextureOrigin::top_left;
  hlod::HlodBuildOptions options;
  options.node_triangles = 64;
  options.within = hlod::Within::splits;
  const Hlod built = build_hlod(mesh, options);
  const std::filesystem::path file = folder_ / "textured.ohlod";
  write(file, built);
  EXPECT_EQ(bytes_of(file)[8], is_packed() ? 6 : 5) << "version";
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

// Up to version 3 boxes were those of what triangles still used.
TEST_P(OhlodTest, BoxesOfOldFilesAreMendedWhenTheyAreOpened) {
  HlodData data = copy_data(hlod_);
  for (hlod::NodeId n = 0; n < hlod_.node_count(); ++n)
    if (hlod_.node(n).level > 0 && hlod_.node(n).triangles > 0)
      data.nodes[n].box = bounding_box(hlod_.mesh(n).positions);
  write(folder_ / "narrow.ohlod", make_hlod(std::move(data)));
  EXPECT_NE(hlod::validate(read_ohlod(folder_ / "narrow.ohlod").hlod, 1), std::vector<std::string>{});
  std::string bytes = bytes_of(folder_ / "narrow.ohlod");
  bytes[8] = static_cast<char>(bytes[8] - 3);
  const std::filesystem::path old = write_bytes(bytes);
  const Hlod read = read_ohlod(old).hlod;
  EXPECT_EQ(hlod::validate(read, 1), std::vector<std::string>{});
  EXPECT_TRUE(restores(read, mesh_));
  const Hlod paged = open_ohlod(old, {}).hlod;
  for (hlod::NodeId n = 0; n < read.node_count(); ++n) {
    EXPECT_EQ(paged.node(n).box.min, read.node(n).box.min) << n;
    EXPECT_EQ(paged.node(n).box.max, read.node(n).box.max) << n;
  }
}

TEST_P(OhlodTest, SaysHowItIsStored) {
  const int version = is_packed() ? 6 : 4;  // without textures
  EXPECT_EQ(bytes_of(write_good())[8], version);
  const OhlodFile file = read_ohlod(folder_ / "good.ohlod");
  EXPECT_EQ(file.compression, GetParam());
  EXPECT_EQ(file.version, static_cast<std::uint32_t>(version));
}

TEST_P(OhlodTest, ComesBackByteForByte) {
  for (const OlodAccess access : {OlodAccess::mapped, OlodAccess::copied}) {
    const OhlodFile file = read_ohlod(write_good(), access);
    EXPECT_TRUE(validate(file.hlod).empty());
    EXPECT_TRUE(restores(file.hlod, mesh_));
    EXPECT_EQ(file.report.vertices_read, 1234U);
    EXPECT_EQ(file.report.left_out.count("groups"), 5U);
    EXPECT_EQ(file.hlod.data().node_triangles, 64U);
    EXPECT_TRUE(file.hlod.data().has_colors);
    EXPECT_FALSE(file.hlod.data().has_normals);
    write_ohlod(folder_ / "again.ohlod", file.hlod, file.report, {.compression = file.compression});
    EXPECT_EQ(bytes_of(folder_ / "again.ohlod"), bytes_of(folder_ / "good.ohlod"));
  }
}

TEST_P(OhlodTest, KindsComeBack) {
  hlod::HlodBuildOptions options;
  options.node_triangles = 64;
  options.grouping = hlod::Grouping::nested;
  options.borders = hlod::Borders::free;
  write(folder_ / "nested.ohlod", build_hlod(mesh_, options));
  const OhlodFile file = read_ohlod(folder_ / "nested.ohlod");
  EXPECT_EQ(file.hlod.data().grouping, hlod::Grouping::nested);
  EXPECT_EQ(file.hlod.data().borders, hlod::Borders::free);
  EXPECT_TRUE(validate(file.hlod).empty());
}

TEST_P(OhlodTest, SplitsComeBackAndAreNotThereWithoutThem) {
  const std::string plain = bytes_of(write_good()), refinable = bytes_of(write_refinable());
  for (const char* section : {"WNOD", is_packed() ? "PSPL" : "WSPL", "WBLK"}) {
    EXPECT_EQ(plain.find(section), std::string::npos);
    EXPECT_NE(refinable.find(section), std::string::npos);
  }
  EXPECT_FALSE(read_ohlod(folder_ / "good.ohlod").hlod.has_within(0));
  for (const OlodAccess access : {OlodAccess::mapped, OlodAccess::copied}) {
    const OhlodFile file = read_ohlod(folder_ / "refinable.ohlod", access);
    EXPECT_TRUE(file.hlod.has_within(0));
    EXPECT_TRUE(validate(file.hlod).empty());
    write_ohlod(folder_ / "again.ohlod", file.hlod, file.report, {.compression = file.compression});
    EXPECT_EQ(bytes_of(folder_ / "again.ohlod"), refinable);
  }
}

TEST_P(OhlodTest, DamagedSplitsAreFoundWhenTheyAreUsed) {
  std::string bad = bytes_of(write_refinable());
  std::uint64_t offset = 0;
  std::memcpy(&offset, bad.data() + bad.find(is_packed() ? "PSPL" : "WSPL") + 8, sizeof(offset));
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

TEST_F(StoredOhlodTest, LiesAboutSplitsAreRefused) {
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

TEST_P(OhlodTest, EveryTruncationIsRefused) {
  for (const std::string& good : {bytes_of(write_good()), bytes_of(write_refinable())}) {
    for (std::size_t size = 0; size < good.size(); size += size < 700 ? 1 : 509)
      EXPECT_NE(refusal(write_bytes(good.substr(0, size))), "") << size << " bytes";
    EXPECT_NE(refusal(write_bytes(good + "x")).find("truncated or has extra bytes"), std::string::npos);
  }
}

TEST_P(OhlodTest, EveryFlippedBitIsRefused) {
  // But for padding between sections, which nothing reads: less than 64 bytes before each of 11 to 16 sections.
  for (const std::string& good : {bytes_of(write_good()), bytes_of(write_refinable())}) {
    std::mt19937 random(3);
    int unseen = 0;
    for (int n = 0; n < 1000; ++n) {
      std::string bad = good;
      const std::size_t at = n < 700 ? static_cast<std::size_t>(n) : random() % bad.size();
      bad[at] = static_cast<char>(bad[at] ^ (1 << (random() % 8)));
      if (refusal(write_bytes(bad)).empty()) ++unseen;
    }
    EXPECT_LT(unseen, 90);
  }
}

TEST_P(OhlodTest, SaysWhatIsWrong) {
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

TEST_P(OhlodTest, DamageIsFoundWhenTheNodeIsUsed) {
  std::string bad = bytes_of(write_good());
  std::uint64_t offset = 0;
  std::memcpy(&offset, bad.data() + bad.find(is_packed() ? "PMSH" : "MESH") + 8, sizeof(offset));
  bad[offset] = static_cast<char>(bad[offset] ^ 1);
  const OhlodFile file = read_ohlod(write_bytes(bad));
  EXPECT_NO_THROW(file.hlod.require(5));
  EXPECT_THROW(file.hlod.require(0), Error);
  EXPECT_THROW(file.hlod.require(0), Error) << "and again";
  EXPECT_THROW((void)validate(file.hlod), Error);
}

// Of files whose meshes and splits are packed, with content that has been changed and good checksums.
class PackedOhlodTest : public OhlodFixture, public ::testing::Test {
 protected:
  using Numbers = std::span<std::uint64_t>;

  PackedOhlodTest() : OhlodFixture(OlodCompression::zstd) {}

  // `lie(meshes, places)`.
  [[nodiscard]] std::string refusal_of_packed(
      const std::function<void(std::span<std::byte> meshes, Numbers places)>& lie) const {
    return refusal_of_packed(ohlod::packed_meshes_name, ohlod::mesh_places_name, ohlod::digests_name, lie);
  }
  [[nodiscard]] std::string refusal_of_packed_splits(
      const std::function<void(std::span<std::byte> splits, Numbers places)>& lie) const {
    return refusal_of_packed(ohlod::packed_splits_name, ohlod::splits_places_name, ohlod::splits_digests_name, lie);
  }

 private:
  [[nodiscard]] std::string refusal_of_packed(std::string_view name, std::string_view places_name,
                                              std::string_view digests_name,
                                              const std::function<void(std::span<std::byte>, Numbers)>& lie) const {
    const std::string good = bytes_of(write_refinable());
    std::vector<std::byte> bytes(good.size());
    std::memcpy(bytes.data(), good.data(), good.size());
    fuzz::SectionSigner signer(bytes, ohlod::file_kind);
    signer.sign([&] {
      const std::span<std::byte> packed = signer.find<std::byte>(name);
      const Numbers places = signer.find<std::uint64_t>(places_name),
                    digests = signer.find<std::uint64_t>(digests_name);
      ASSERT_EQ(digests.size() + 1, places.size());
      lie(packed, places);
      for (std::size_t n = 0; n < digests.size(); ++n)
        if (places[n] <= places[n + 1] && places[n + 1] <= packed.size())
          digests[n] = sections::checksum_of(packed.subspan(places[n], places[n + 1] - places[n]));
    });
    return refusal(write_bytes({reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
  }
};

TEST_F(PackedOhlodTest, LiesAboutPlacesAreRefused) {
  EXPECT_EQ(refusal_of_packed([](auto, Numbers) {}), "");
  const std::string divides = "section PMPL: does not divide section PMSH between nodes";
  EXPECT_NE(refusal_of_packed([](auto, Numbers places) { places[0] = 1; }).find(divides), std::string::npos);
  EXPECT_NE(refusal_of_packed([](auto, Numbers places) { std::swap(places[3], places[4]); }).find(divides),
            std::string::npos);
  EXPECT_NE(refusal_of_packed([](auto, Numbers places) { places.back() += 1; }).find(divides), std::string::npos);
  EXPECT_NE(refusal_of_packed([](auto, Numbers places) {
              places[2] = places[1];
            }).find("section PMPL: node 1 has too few bytes"),
            std::string::npos);
  EXPECT_NE(refusal_of_packed_splits([](auto, Numbers places) {
              places[0] = 1;
            }).find("section PSPP: does not divide section PSPL between nodes"),
            std::string::npos);
}

TEST_F(PackedOhlodTest, LiesInPackedNodesAreRefused) {
  const auto refused = [&](const std::string& line) { return line.find("node 1: is damaged") != std::string::npos; };
  // A lattice that there is none of; a frame that is none; one byte less for a node, one more.
  EXPECT_TRUE(refused(refusal_of_packed([](auto bytes, Numbers places) { bytes[places[1]] = std::byte{255}; })));
  EXPECT_TRUE(refused(refusal_of_packed([](auto bytes, Numbers places) { bytes[places[1] + 1] = std::byte{0}; })));
  EXPECT_TRUE(refused(refusal_of_packed([](auto, Numbers places) { places[2] -= 1; })));
  EXPECT_NE(refusal_of_packed([](auto, Numbers places) { places[2] += 1; }).find("is damaged"), std::string::npos);
  EXPECT_NE(refusal_of_packed_splits([](auto bytes, Numbers places) {
              bytes[places[1]] = std::byte{255};
            }).find("splits of node 1: are damaged"),
            std::string::npos);
}

TEST_F(PackedOhlodTest, TakesFewerBytes) {
  hlod::HlodBuildOptions options;
  options.within = hlod::Within::splits;
  const Hlod hlod = build_hlod(mesh_, options);
  for (const OlodCompression compression : {OlodCompression::none, OlodCompression::zstd})
    write_ohlod(folder_ / std::to_string(static_cast<int>(compression)), hlod, report_, {.compression = compression});
  EXPECT_LT(3 * std::filesystem::file_size(folder_ / "1"), 2 * std::filesystem::file_size(folder_ / "0"));
}

// The nodes of a file are unpacked by whichever thread needs them first.
TEST_F(PackedOhlodTest, ThreadsMayShareIt) {
  const Hlod file = read_ohlod(write_refinable()).hlod;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&file] {
      for (hlod::NodeId n = 0; n < file.node_count(); ++n) {
        file.require(n);
        file.require_within(n);
      }
    });
  for (std::thread& thread : threads) thread.join();
  const Hlod built = refinable();
  EXPECT_TRUE(std::ranges::equal(file.data().meshes, built.data().meshes));
  EXPECT_TRUE(std::ranges::equal(file.data().splits, built.data().splits));
}

TEST_F(StoredOhlodTest, LiesWithGoodChecksumsAreRefused) {
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
