// .ohlod files whose meshes are read as they are needed, and what becomes of files meanwhile.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <random>

#include "hlod/store/ohlod.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/node_store.h"
#include "support/meshes.h"

namespace occlod {
namespace {

using hlod::NodeId;

class OpenOhlodTest : public ::testing::TestWithParam<OlodCompression> {
 protected:
  OpenOhlodTest() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("occlod_open_ohlod_") + test->name();
    std::ranges::replace(name, '/', '_');
    folder_ = std::filesystem::path(::testing::TempDir()) / name;
    std::filesystem::create_directories(folder_);
    hlod::HlodBuildOptions options;
    options.node_triangles = 64;
    options.within = hlod::Within::splits;
    built_ = build_hlod(test::noisy_sphere(5, 1), options);
    path_ = folder_ / "good.ohlod";
    write_ohlod(path_, built_, {}, {.compression = GetParam()});
    sections::SectionReader reader(path_, ohlod::file_kind, true);
    const bool is_packed = GetParam() != OlodCompression::none;
    meshes_ = reader.offset_of(is_packed ? ohlod::packed_meshes_name : ohlod::meshes_name);
    if (is_packed) {
      const auto places = reader.read<std::uint64_t>(ohlod::mesh_places_name);
      places_.assign(places.begin(), places.end());
    } else {
      for (const hlod::Node& node : built_.data().nodes) places_.push_back(node.mesh);
      places_.push_back(built_.data().meshes.size());
    }
  }
  ~OpenOhlodTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string bytes() const {
    std::ifstream stream(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  // Over the bytes of the file, which stays the same file.
  void overwrite(std::uint64_t offset, const std::string& bytes) const {
    std::fstream stream(path_, std::ios::binary | std::ios::in | std::ios::out);
    stream.seekp(static_cast<std::streamoff>(offset));
    stream << bytes;
  }
  [[nodiscard]] std::vector<NodeId> all() const {
    std::vector<NodeId> nodes(built_.node_count());
    for (NodeId n = 0; n < nodes.size(); ++n) nodes[n] = n;
    return nodes;
  }
  // Level by level, as they come when those above them are drawn.
  void fetch_all(const hlod::Hlod& hlod) const {
    hlod.store()->begin_frame();
    for (const NodeId n : all()) static_cast<void>(hlod.store()->fetch({&n, 1}));
    hlod.store()->end_frame();
  }

  std::filesystem::path folder_, path_;
  hlod::Hlod built_;
  std::uint64_t meshes_ = 0;           // where they begin in the file
  std::vector<std::uint64_t> places_;  // from there, of each node's, and the end
  hlod::CacheOptions cache_{.load = hlod::LoadMode::blocking};
};

INSTANTIATE_TEST_SUITE_P(Of, OpenOhlodTest, ::testing::Values(OlodCompression::none, OlodCompression::zstd),
                         [](const auto& of) { return of.param == OlodCompression::none ? "stored" : "packed"; });

// The thread that reads is not in the child, which must not wait for it.
TEST_P(OpenOhlodTest, IsRefusedInAChildOfFork) {
  cache_.load = hlod::LoadMode::async;
  std::optional<hlod::Hlod> hlod(open_ohlod(path_, cache_).hlod);
  fetch_all(*hlod);
  const pid_t child = fork();
  if (child == 0) {
    alarm(20);
    int code = 1;
    try {
      fetch_all(*hlod);
    } catch (const Error& error) {
      code = error.diagnosis().problem.starts_with("was opened before this process was forked") ? 0 : 2;
    }
    hlod.reset();
    _exit(code);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  fetch_all(*hlod);
}

TEST_P(OpenOhlodTest, GivesTheMeshesOfTheFile) {
  const OhlodFile file = open_ohlod(path_, cache_);
  EXPECT_EQ(file.hlod.node_count(), built_.node_count());
  EXPECT_EQ(file.hlod.store()->stats().loads, built_.data().roots.size());
  EXPECT_TRUE(file.hlod.data().within.empty());
  EXPECT_LT(file.hlod.bytes(), built_.bytes() / 2);
  fetch_all(file.hlod);
  for (const NodeId n : all()) {
    ASSERT_NO_THROW(file.hlod.require(n));
    const hlod::NodeMesh mesh = file.hlod.mesh(n), truth = built_.mesh(n);
    EXPECT_TRUE(std::ranges::equal(mesh.positions, truth.positions));
    EXPECT_TRUE(std::ranges::equal(mesh.indices, truth.indices));
    EXPECT_TRUE(std::ranges::equal(mesh.merged_into, truth.merged_into));
  }
  EXPECT_EQ(file.hlod.store()->stats().bytes_loaded, places_.back());
  EXPECT_EQ(file.hlod.store()->stats().resident_bytes, built_.data().meshes.size());
  EXPECT_TRUE(file.hlod.store()->take_failures().empty());
}

// Any bit of a mesh: the node and what is below it do not come, all else does.
TEST_P(OpenOhlodTest, ADamagedMeshIsOneLine) {
  const std::string good = bytes();
  std::mt19937_64 random(1);
  for (int i = 0; i < 40; ++i) {
    const NodeId n = 1 + static_cast<NodeId>(random() % (built_.node_count() - 1));
    const std::uint64_t place = meshes_ + places_[n] + random() % (places_[n + 1] - places_[n]);
    overwrite(place, std::string(1, static_cast<char>(good[place] ^ (1 << random() % 8))));
    const OhlodFile file = open_ohlod(path_, cache_);
    fetch_all(file.hlod);
    fetch_all(file.hlod);
    const std::vector<std::string> lines = file.hlod.store()->take_failures();
    ASSERT_EQ(lines.size(), 1U);
    EXPECT_NE(lines[0].find("node " + std::to_string(n) + ": is damaged"), std::string::npos) << lines[0];
    EXPECT_NE(lines[0].find(path_.string()), std::string::npos) << lines[0];
    for (const NodeId other : all()) {
      bool comes = other != n;
      for (const hlod::Patch& patch : built_.patches(other))
        comes = comes && (patch.parent == no_id || file.hlod.is_resident(patch.parent));
      EXPECT_EQ(file.hlod.is_resident(other), comes) << other;
    }
    overwrite(place, good.substr(place, 1));
  }
}

TEST_P(OpenOhlodTest, DamagedRootsAndTablesAreErrors) {
  const std::string good = bytes();
  for (const char* section : {"NODE", "PTCH", "CHIL", "ROOT", "LEVL", "BLOK", "INFO"}) {
    std::uint64_t offset = 0;
    std::copy_n(good.data() + good.find(section) + 8, sizeof(offset), reinterpret_cast<char*>(&offset));
    overwrite(offset, std::string(1, static_cast<char>(good[offset] ^ 4)));
    EXPECT_THROW((void)open_ohlod(path_, cache_), Error) << section;
    overwrite(offset, good.substr(offset, 1));
  }
  overwrite(meshes_, std::string(1, static_cast<char>(good[meshes_] ^ 4)));
  try {
    (void)open_ohlod(path_, cache_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()), path_.string() +
                                             ": node 0: is damaged: its checksum is wrong; build it again "
                                             "with 'occlod hlod build'");
  }
  EXPECT_THROW((void)open_ohlod(folder_ / "none.ohlod", cache_), Error);
}

// Another file under the same name is none of our business; the same file cut short is a coarser picture.
TEST_P(OpenOhlodTest, WhatBecomesOfTheFile) {
  {
    const OhlodFile file = open_ohlod(path_, cache_);
    std::ofstream(folder_ / "other", std::ios::binary) << "something else";
    std::filesystem::rename(folder_ / "other", path_);
    fetch_all(file.hlod);
    EXPECT_EQ(file.hlod.store()->stats().resident_nodes, built_.node_count());
  }
  write_ohlod(path_, built_, {}, {.compression = GetParam()});
  const OhlodFile file = open_ohlod(path_, cache_);
  const NodeId last = static_cast<NodeId>(built_.node_count() - 1);
  std::filesystem::resize_file(path_, meshes_ + places_[last] + 100);
  fetch_all(file.hlod);
  EXPECT_EQ(file.hlod.store()->stats().resident_nodes, built_.node_count() - 1);
  const std::vector<std::string> lines = file.hlod.store()->take_failures();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find("node " + std::to_string(last) + ": cannot be read"), std::string::npos) << lines[0];
}

}  // namespace
}  // namespace occlod
