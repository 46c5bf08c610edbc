// .ohlod files whose bytes somebody else fetches: which are asked for, and what becomes of answers.
#include "hlod/store/remote_ohlod.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "hlod/store/ohlod.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "support/meshes.h"

namespace occlod::hlod {
namespace {

class RemoteOhlodTest : public ::testing::TestWithParam<OlodCompression> {
 protected:
  RemoteOhlodTest() {
    HlodBuildOptions options;
    options.node_triangles = 64;
    options.within = Within::splits;
    built_ = build_hlod(test::noisy_sphere(6, 1), options);
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("occlod_remote_") + test->name() + ".ohlod";
    std::ranges::replace(name, '/', '_');
    path_ = std::filesystem::path(::testing::TempDir()) / name;
    write_ohlod(path_, built_, {}, GetParam());
    std::ifstream stream(path_, std::ios::binary);
    content_ = {std::istreambuf_iterator<char>(stream), {}};
  }
  ~RemoteOhlodTest() override { std::filesystem::remove(path_); }

  [[nodiscard]] std::span<const std::byte> bytes(const ByteRange& range) const {
    return std::as_bytes(std::span(content_)).subspan(range.begin, range.end - range.begin);
  }
  // Puts what is missing. Returns how often something was, and adds up how much.
  int open(RemoteOhlod& remote, std::size_t budget = std::size_t{1} << 30U) {
    for (int rounds = 0;; ++rounds) {
      const std::vector<ByteRange> missing = remote.open({.budget_bytes = budget});
      if (missing.empty()) return rounds;
      for (const ByteRange& range : missing) {
        EXPECT_LT(range.begin, range.end);
        EXPECT_LE(range.end, content_.size());
        fetched_ += range.end - range.begin;
        remote.put(range.begin, bytes(range));
      }
      if (rounds > 50) throw std::runtime_error("asks for ever");
    }
  }
  [[nodiscard]] std::vector<NodeId> all() const {
    std::vector<NodeId> nodes(built_.node_count());
    for (NodeId n = 0; n < nodes.size(); ++n) nodes[n] = n;
    return nodes;
  }
  static void frame(const Hlod& hlod, std::span<const NodeId> wanted = {}) {
    hlod.store()->begin_frame();
    for (const NodeId n : wanted) hlod.store()->want({&n, 1}, 1.0);
    hlod.store()->end_frame();
  }
  // Frames in which all nodes are wanted, and each request is answered by `answer`, until no more come.
  template <typename Answer>
  void fetch_all(RemoteOhlod& remote, const Answer& answer) {
    for (int i = 0; i < 200; ++i) {
      frame(remote.file().hlod, all());
      while (const auto request = remote.next()) answer(*request);
    }
  }

  Hlod built_;
  std::filesystem::path path_;
  std::string content_;
  std::size_t fetched_ = 0;
};

INSTANTIATE_TEST_SUITE_P(Of, RemoteOhlodTest, ::testing::Values(OlodCompression::none, OlodCompression::zstd),
                         [](const auto& of) { return of.param == OlodCompression::none ? "stored" : "packed"; });

// Header, tables, roots; splits and the other meshes are not needed.
TEST_P(RemoteOhlodTest, OpensWithAFewPieces) {
  RemoteOhlod remote("far.ohlod", content_.size());
  const int rounds = open(remote);
  EXPECT_LE(rounds, 3);
  EXPECT_LT(fetched_, content_.size() / 2);
  const Hlod& hlod = remote.file().hlod;
  // Tables of packed files come packed: all that is fetched is less than two of them and the first meshes.
  if (GetParam() != OlodCompression::none) {
    EXPECT_LT(fetched_, hlod.data().nodes.size_bytes() + hlod.data().patches.size_bytes() + (64U << 10U));
  }
  EXPECT_EQ(hlod.node_count(), built_.node_count());
  EXPECT_EQ(hlod.store()->stats().resident_nodes, built_.data().roots.size());
  EXPECT_FALSE(remote.next().has_value());
}

TEST_P(RemoteOhlodTest, GivesTheMeshesOfTheFile) {
  RemoteOhlod remote("far.ohlod", content_.size());
  open(remote);
  std::uint64_t last_end = 0;
  std::size_t requests = 0;
  fetch_all(remote, [&](const RemoteRequest& request) {
    ++requests;
    last_end = std::max(last_end, request.range.end);
    EXPECT_FALSE(request.again);
    remote.arrive(request.id, bytes(request.range));
  });
  EXPECT_LT(requests, built_.node_count() / 4) << "neighbours come together";
  const Hlod& hlod = remote.file().hlod;
  for (const NodeId n : all()) {
    ASSERT_TRUE(hlod.is_resident(n)) << n;
    const NodeMesh mesh = hlod.mesh(n), truth = built_.mesh(n);
    EXPECT_TRUE(std::ranges::equal(mesh.positions, truth.positions));
    EXPECT_TRUE(std::ranges::equal(mesh.indices, truth.indices));
  }
  EXPECT_TRUE(remote.take_cancelled().empty());
}

// A quarter of all answers never comes, another is cut short, the first two among them: the same in the end.
TEST_P(RemoteOhlodTest, WhatIsLostIsAskedForAgain) {
  RemoteOhlod remote("far.ohlod", content_.size());
  open(remote);
  int count = 0, lost = 0;
  fetch_all(remote, [&](const RemoteRequest& request) {
    const std::span<const std::byte> good = bytes(request.range);
    switch (count++ % 4) {
      case 0:
        ++lost;
        return remote.lose(request.id);
      case 1:
        ++lost;
        return remote.arrive(request.id, good.first(good.size() / 2));
      default:
        return remote.arrive(request.id, good);
    }
  });
  EXPECT_GT(lost, 1);
  EXPECT_EQ(remote.file().hlod.store()->stats().resident_nodes, built_.node_count());
  EXPECT_EQ(remote.file().hlod.store()->stats().failed, 0U);
}

TEST_P(RemoteOhlodTest, DamageIsHealedOnceAndThenOneLine) {
  const NodeId victim = static_cast<NodeId>(built_.node_count() / 2);
  for (const bool heals : {true, false}) {
    RemoteOhlod remote("far.ohlod", content_.size());
    open(remote);
    sections::SectionReader reader(path_, ohlod::file_kind, true);
    const bool is_packed = GetParam() != OlodCompression::none;
    const std::uint64_t place =
        reader.offset_of(is_packed ? ohlod::packed_meshes_name : ohlod::meshes_name) +
        (is_packed ? reader.read<std::uint64_t>(ohlod::mesh_places_name)[victim] : built_.node(victim).mesh);
    int again = 0;
    fetch_all(remote, [&](const RemoteRequest& request) {
      std::vector<std::byte> answer(bytes(request.range).begin(), bytes(request.range).end());
      if (request.again) ++again;
      if (place >= request.range.begin && place < request.range.end && !(heals && request.again))
        answer[place - request.range.begin] ^= std::byte{16};
      remote.arrive(request.id, answer);
    });
    EXPECT_EQ(again, 1);
    const Hlod& hlod = remote.file().hlod;
    EXPECT_EQ(hlod.is_resident(victim), heals);
    const std::vector<std::string> lines = hlod.store()->take_failures();
    ASSERT_EQ(lines.size(), heals ? 0U : 1U);
    if (!heals) {
      EXPECT_TRUE(lines[0].starts_with("far.ohlod: node " + std::to_string(victim) + ": is damaged"));
    }
    EXPECT_EQ(hlod.store()->stats().resident_nodes == built_.node_count(), heals);
  }
}

TEST_P(RemoteOhlodTest, WhatIsRefusedFails) {
  RemoteOhlod remote("far.ohlod", content_.size());
  open(remote);
  fetch_all(remote, [&](const RemoteRequest& request) { remote.fail(request.id, "far.ohlod: is gone"); });
  const std::vector<std::string> lines = remote.file().hlod.store()->take_failures();
  EXPECT_FALSE(lines.empty());
  EXPECT_TRUE(std::ranges::all_of(lines, [](const std::string& line) { return line == "far.ohlod: is gone"; }));
  EXPECT_EQ(remote.file().hlod.store()->stats().resident_nodes, built_.data().roots.size());
}

// A request whose nodes are wanted again is kept, another is cancelled, and late answers to it are ignored.
TEST_P(RemoteOhlodTest, WhatIsNoLongerWantedIsCancelled) {
  RemoteOhlod remote("far.ohlod", content_.size());
  open(remote);
  const Hlod& hlod = remote.file().hlod;
  const auto children = built_.children(built_.data().roots[0]);
  const std::vector<NodeId> wanted(children.begin(), children.end());
  frame(hlod, wanted);
  const auto first = remote.next();
  ASSERT_TRUE(first.has_value());
  frame(hlod, wanted);
  EXPECT_TRUE(remote.take_cancelled().empty());
  EXPECT_FALSE(remote.next().has_value()) << "it is on its way";
  EXPECT_GT(hlod.store()->stats().loading_bytes, 0U);
  frame(hlod);
  EXPECT_EQ(remote.take_cancelled(), std::vector<std::uint32_t>{first->id});
  EXPECT_EQ(hlod.store()->stats().loading_bytes, 0U);
  remote.arrive(first->id, bytes(first->range));
  frame(hlod);
  EXPECT_EQ(hlod.store()->stats().resident_nodes, built_.data().roots.size());
  frame(hlod, wanted);
  const auto second = remote.next();
  ASSERT_TRUE(second.has_value());
  EXPECT_NE(second->id, first->id);
  remote.arrive(second->id, bytes(second->range));
  frame(hlod);
  EXPECT_EQ(hlod.store()->stats().resident_nodes, built_.data().roots.size() + wanted.size());
}

TEST_P(RemoteOhlodTest, KeepsItsBudget) {
  RemoteOhlod remote("far.ohlod", content_.size());
  const std::size_t budget = built_.data().meshes.size() / 3;
  open(remote, budget);
  const NodeStore& store = *remote.file().hlod.store();
  fetch_all(remote, [&](const RemoteRequest& request) {
    remote.arrive(request.id, bytes(request.range));
    EXPECT_LE(store.stats().resident_bytes + store.stats().loading_bytes, budget);
  });
  EXPECT_GT(store.stats().resident_bytes, budget / 2);
}

TEST_P(RemoteOhlodTest, BadFilesAreRefusedAtOnce) {
  const auto problem = [&](const std::string& content, std::uint64_t size) {
    RemoteOhlod remote("far.ohlod", size);
    try {
      for (int rounds = 0; rounds < 50; ++rounds) {
        const std::vector<ByteRange> missing = remote.open({});
        if (missing.empty()) return std::string();
        for (const ByteRange& range : missing)
          remote.put(range.begin, std::as_bytes(std::span(content)).subspan(range.begin, range.end - range.begin));
      }
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("asks for ever");
  };
  EXPECT_EQ(problem(content_, content_.size()), "");
  EXPECT_NE(problem("PLY" + content_.substr(3), content_.size()).find("is not an .ohlod file"), std::string::npos);
  EXPECT_NE(problem(content_.substr(0, 20), 20).find("is not an .ohlod file"), std::string::npos);
  EXPECT_NE(problem(content_.substr(0, 9000), 9000).find("truncated"), std::string::npos);
  for (std::size_t place = 0; place < 2000; place += 7) {
    std::string broken = content_;
    broken[place] = static_cast<char>(broken[place] ^ 32);
    EXPECT_NE(problem(broken, broken.size()), "asks for ever") << place;
  }
}

}  // namespace
}  // namespace occlod::hlod
