#include "occlod/vlod_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <functional>
#include <optional>
#include <random>
#include <set>
#include <stdexcept>

#include "cells/vlod_format.h"
#include "fuzz/memory_file.h"
#include "mesh/section_file.h"
#include "occlod/base.h"
#include "small_cells.h"

namespace occlod {
namespace {

// On no disk: thousands of files are written.
class FileOf : public fuzz::MemoryFile {
 public:
  explicit FileOf(const std::string& bytes)
      : MemoryFile(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()) {}
};

class VlodFileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("vlod_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
    good_ = folder_ / "good.vlod";
    CellBuild(objects_, options_).write(good_, 1);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // What opening a file with these bytes says; nothing if it can be opened.
  [[nodiscard]] std::string refusal(const std::string& bytes) const {
    try {
      static_cast<void>(open_vlod(FileOf(bytes).path()));
      return "";
    } catch (const Error& error) {
      return error.what();
    }
  }
  // The nodes that cannot be read where all above them can; those below are not tried. `what`: said of the last.
  [[nodiscard]] std::set<CellId> unreadable(const std::string& bytes, std::string* what = nullptr) const {
    const FileOf in_memory(bytes);
    const auto file = open_vlod(in_memory.path(), objects_);
    std::set<CellId> bad;
    std::vector<const CellAdditions*> above;
    const std::function<void(CellId)> visit = [&](CellId n) {
      std::optional<CellAdditions> additions;
      try {
        additions = file->read(n, above);
      } catch (const Error& error) {
        if (what != nullptr) *what = error.what();
        bad.insert(n);
        return;
      }
      above.push_back(&*additions);
      for (CellId child = n + 1; child < file->tree().node(n).end; child = file->tree().node(child).end) visit(child);
      above.pop_back();
    };
    visit(0);
    return bad;
  }
  // The file with one node's payload changed, and all checksums put right.
  [[nodiscard]] std::string with_lie(CellId cell, const std::function<void(CellNode&, std::vector<char>&)>& lie) const {
    std::string bytes = test::bytes_of_file(good_);
    sections::FileHeader header;
    std::memcpy(&header, bytes.data(), sizeof(header));
    std::vector<sections::Section> table(header.section_count);
    std::memcpy(table.data(), bytes.data() + sizeof(header), table.size() * sizeof(sections::Section));
    const auto section = [&](std::string_view name) -> sections::Section& {
      return *std::ranges::find_if(
          table, [&](const sections::Section& s) { return std::string_view(s.name.data(), 4) == name; });
    };
    sections::Section& nodes = section(vlod::nodes_name);
    CellNode node;
    char* const at = bytes.data() + nodes.offset + cell * sizeof(CellNode);
    std::memcpy(&node, at, sizeof(node));
    char* const payload = bytes.data() + section(vlod::data_name).offset + node.payload;
    std::vector<char> changed(payload, payload + node.payload_bytes);
    lie(node, changed);
    std::memcpy(payload, changed.data(), changed.size());
    node.checksum = sections::checksum_of(std::as_bytes(std::span(changed)));
    std::memcpy(at, &node, sizeof(node));
    nodes.checksum = sections::checksum_of(std::as_bytes(std::span(bytes)).subspan(nodes.offset, nodes.bytes));
    header.table_checksum = sections::checksum_of(std::as_bytes(std::span(table)));
    std::memcpy(bytes.data(), &header, sizeof(header));
    std::memcpy(bytes.data() + sizeof(header), table.data(), table.size() * sizeof(sections::Section));
    return bytes;
  }

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

TEST_F(VlodFileTest, SaysWhatItWasBuiltWith) {
  const auto file = open_vlod(good_);
  EXPECT_EQ(file->options().cell.eyes, options_.cell.eyes);
  EXPECT_EQ(file->options().cell.tolerance_px, options_.cell.tolerance_px);
  EXPECT_EQ(file->options().regions, options_.regions);
  EXPECT_EQ(file->options().root_cell, 0.5);
  EXPECT_EQ(file->options().smallest_cell, 0.125);
  EXPECT_EQ(file->options().max_triangles, 300U);
  EXPECT_EQ(file->options().division, CellDivision::gain);
  EXPECT_EQ(file->options().occluder_motion, 0.01);
  EXPECT_EQ(file->object_count(), 3U);
  EXPECT_EQ(file->file_bytes(), std::filesystem::file_size(good_));
}

TEST_F(VlodFileTest, KeepsBudgetAndKindOfOcclusion) {
  CellTreeOptions others = options_;
  others.cell.occlusion = CellOcclusion::none;
  others.cell.budget = 2000;
  CellBuild(objects_, others).write(folder_ / "others.vlod");
  const auto file = open_vlod(folder_ / "others.vlod", objects_);
  EXPECT_EQ(file->options().cell.occlusion, CellOcclusion::none);
  EXPECT_EQ(file->options().cell.budget, 2000U);
  EXPECT_EQ(file->options().cell.sampled_eyes, others.cell.sampled_eyes);
  EXPECT_NE(file->key(), open_vlod(good_)->key());
  CellBuilder builder(objects_, nullptr, others.cell);
  for (CellId n = 0; n < file->tree().nodes().size(); ++n) {
    EXPECT_EQ(file->tree().node(n).hidden_faces, 0U);
    if (!file->tree().is_leaf(n)) continue;
    EXPECT_LE(file->tree().node(n).triangles, 2000U);
    const CellCut& expected = builder.build(file->tree().node(n).box);
    const std::vector<CellObjectCut> cuts = read_cell(*file, objects_, n);
    for (std::size_t i = 0; i < cuts.size(); ++i) EXPECT_EQ(cuts[i].triangles, expected.objects[i].triangles);
  }
}

TEST_F(VlodFileTest, HasTheSameBytesForAnyNumberOfThreadsAndParts) {
  const std::string good = test::bytes_of_file(good_);
  CellBuild build(objects_, options_);
  for (const int threads : {2, 3}) {
    build.write(folder_ / "again.vlod", threads);
    EXPECT_EQ(test::bytes_of_file(folder_ / "again.vlod"), good) << threads << " threads";
  }
  for (const std::uint32_t shards : {1U, 3U, 7U, 64U}) {
    std::vector<std::filesystem::path> parts;
    for (std::uint32_t i = shards; i-- > 0;) {  // in any order
      const CellRange range = build.shard(i, shards);
      if (range.count == 0) continue;
      parts.push_back(folder_ / build.part_name(range));
      build.write_part(parts.back(), range, 1 + static_cast<int>(i % 2));
    }
    EXPECT_EQ(parts.size(), std::min(shards, build.root_cell_count()));
    merge_cells(parts, folder_ / "merged.vlod");
    EXPECT_EQ(test::bytes_of_file(folder_ / "merged.vlod"), good) << shards << " shards";
  }
  merge_cells(cell_parts_in(folder_), folder_ / "merged.vlod");
  EXPECT_EQ(test::bytes_of_file(folder_ / "merged.vlod"), good) << "from parts that overlap";
}

TEST_F(VlodFileTest, PartsAreTakenAgainOnlyIfTheyAreGood) {
  CellBuild build(objects_, options_);
  const CellRange range{1, 2};
  const std::filesystem::path part = folder_ / build.part_name(range);
  EXPECT_FALSE(build.has_part(part, range));
  build.write_part(part, range);
  EXPECT_TRUE(build.has_part(part, range));
  EXPECT_FALSE(build.has_part(part, {1, 3}));
  CellTreeOptions others = options_;
  others.cell.tolerance_px = 2.0;
  EXPECT_FALSE(CellBuild(objects_, others).has_part(part, range));
  EXPECT_NE(CellBuild(objects_, others).part_name(range), build.part_name(range));

  const std::string good = test::bytes_of_file(part);
  int unseen = 0;
  std::mt19937 random(4);
  for (std::size_t at = 0; at < good.size(); at += at < 1000 ? 1 : 1 + random() % 200) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ (1 << (random() % 8)));
    unseen += build.has_part(FileOf(bad).path(), range) ? 1 : 0;
    EXPECT_FALSE(build.has_part(FileOf(good.substr(0, at)).path(), range)) << at << " bytes";
  }
  EXPECT_LT(unseen, 7 * 64) << "padding before seven sections may change unseen";
}

TEST_F(VlodFileTest, MergingSaysWhatIsWrong) {
  CellBuild build(objects_, options_);
  const auto refusal_of = [&](const std::vector<std::filesystem::path>& parts) -> std::string {
    try {
      merge_cells(parts, folder_ / "merged.vlod");
      return "";
    } catch (const Error& error) {
      return error.what();
    }
  };
  const std::uint32_t count = build.root_cell_count();
  build.write_part(folder_ / "first.vpart", {0, 2});
  build.write_part(folder_ / "last.vpart", {3, count - 3});
  EXPECT_NE(refusal_of({folder_ / "first.vpart", folder_ / "last.vpart"}).find("lacks the root cells 2 to 2"),
            std::string::npos);
  EXPECT_NE(refusal_of({folder_ / "last.vpart"}).find("lacks the root cells 0 to 2"), std::string::npos);
  EXPECT_NE(refusal_of({folder_ / "first.vpart"}).find("lacks the root cells 2 to"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "merged.vlod"));
  CellTreeOptions others = options_;
  others.cell.tolerance_px = 2.0;
  CellBuild(objects_, others).write_part(folder_ / "other.vpart", {2, 1});
  EXPECT_NE(refusal_of({folder_ / "first.vpart", folder_ / "other.vpart"})
                .find("other.vpart: is of another scene or of other options"),
            std::string::npos);
  EXPECT_NE(refusal_of({}).find("no parts"), std::string::npos);
  EXPECT_NE(refusal_of({good_}).find("is not an .vpart file"), std::string::npos);
  EXPECT_THROW(build.write_part(folder_ / "x.vpart", {count, 1}), Error);
  EXPECT_THROW(build.write_part(folder_ / "x.vpart", {0, 0}), Error);
}

TEST_F(VlodFileTest, CancellingLeavesTheOldFile) {
  const std::string good = test::bytes_of_file(good_);
  int calls = 0;
  EXPECT_THROW(CellBuild(objects_, options_).write(good_, 1, [&](double) { return ++calls < 2; }), Error);
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(test::bytes_of_file(good_), good);
  const auto throws = [](double) -> bool { throw std::runtime_error("from the caller"); };
  EXPECT_THROW(CellBuild(objects_, options_).write(good_, 3, throws), std::runtime_error);
  EXPECT_EQ(test::bytes_of_file(good_), good);
  double last = -1.0;
  CellBuild(objects_, options_).write(good_, 1, [&](double done) {
    EXPECT_GE(done, last);
    EXPECT_LE(done, 1.0);
    last = done;
    return true;
  });
  EXPECT_EQ(test::bytes_of_file(good_), good);
  EXPECT_NEAR(last, 1.0, 1e-9);
}

TEST_F(VlodFileTest, BadOptionsAreRefused) {
  const auto refused = [&](const auto& change) {
    CellTreeOptions bad = options_;
    change(bad);
    EXPECT_THROW(CellBuild(objects_, bad), Error);
  };
  refused([](CellTreeOptions& o) { o.regions.clear(); });
  refused([](CellTreeOptions& o) { o.regions[0].min.x = 1e9; });
  refused([](CellTreeOptions& o) { o.regions[0].max.y = std::numeric_limits<double>::quiet_NaN(); });
  refused([](CellTreeOptions& o) { o.root_cell = 0.0; });
  refused([](CellTreeOptions& o) { o.root_cell = 1e-9; });
  refused([](CellTreeOptions& o) { o.smallest_cell = -1.0; });
  refused([](CellTreeOptions& o) { o.division = static_cast<CellDivision>(7); });
  refused([](CellTreeOptions& o) { o.occluder_motion = -0.5; });
  refused([](CellTreeOptions& o) { o.cell.tolerance_px = 0.0; });
  refused([](CellTreeOptions& o) { o.cell.eyes.near = 0.0; });
  refused([](CellTreeOptions& o) { o.cell.occlusion = static_cast<CellOcclusion>(3); });
  refused([](CellTreeOptions& o) { o.cell.sampled_eyes = 0; });
  const RefineObject missing[] = {RefineObject{}};
  EXPECT_THROW(CellBuild(missing, options_), Error);
  EXPECT_THROW(CellBuild(objects_, options_).write(good_, -1), Error);
}

TEST_F(VlodFileTest, ChangedScenesAreRefusedByName) {
  const std::vector<std::string> names = {"wall.ply", "ball.ply", "other.ply"};
  const auto refusal_of = [&](const auto& change) -> std::string {
    std::vector<RefineObject> changed(objects_.begin(), objects_.end());
    change(changed);
    try {
      static_cast<void>(open_vlod(good_, changed, names));
      return "";
    } catch (const Error& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refusal_of([](auto&) {}), "");
  EXPECT_NE(refusal_of([](auto& o) { o.pop_back(); }).find("its cells are of 3 objects, the scene has 2"),
            std::string::npos);
  EXPECT_NE(refusal_of([](auto& o) { o[1].hierarchy = o[0].hierarchy; }).find("object 1 (ball.ply): has changed"),
            std::string::npos);
  EXPECT_NE(
      refusal_of([](auto& o) { o[2].object_to_world[3][0] += 1e-9; }).find("object 2 (other.ply): has been moved"),
      std::string::npos);
  EXPECT_NE(
      refusal_of([](auto& o) { o[0].two_sided = true; }).find("object 0 (wall.ply): is now seen from other sides"),
      std::string::npos);
}

TEST_F(VlodFileTest, EveryTruncationIsRefused) {
  const std::string good = test::bytes_of_file(good_);
  for (std::size_t size = 0; size < good.size(); ++size) ASSERT_NE(refusal(good.substr(0, size)), "") << size;
  EXPECT_NE(refusal(good + "x").find("truncated or has extra bytes"), std::string::npos);
}

TEST_F(VlodFileTest, EveryFlippedByteIsFound) {
  const std::string good = test::bytes_of_file(good_);
  const auto file = open_vlod(good_);
  const CellTree& tree = file->tree();
  const std::uint64_t data = file->file_bytes() - tree.nodes().back().payload - tree.nodes().back().payload_bytes;
  std::size_t unseen = 0;
  std::mt19937 random(1);
  for (std::size_t at = 0; at < good.size(); ++at) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ (1 << (random() % 8)));
    if (at < data) {
      unseen += refusal(bad).empty() ? 1U : 0U;
      continue;
    }
    const auto node = std::ranges::find_if(tree.nodes(), [&](const CellNode& n) {
      return at - data >= n.payload && at - data < n.payload + n.payload_bytes;
    });
    ASSERT_TRUE(node != tree.nodes().end()) << "nothing lies between payloads";
    ASSERT_EQ(unreadable(bad), std::set{static_cast<CellId>(node - tree.nodes().begin())}) << "byte " << at;
  }
  EXPECT_LT(unseen, 5 * 64U) << "padding before five sections may change unseen";
}

TEST_F(VlodFileTest, LiesAreFoundWhereTheyAreRead) {
  std::string what;
  EXPECT_EQ(unreadable(with_lie(0, [](CellNode&, std::vector<char>&) {})), std::set<CellId>{});
  EXPECT_EQ(unreadable(with_lie(1, [](CellNode& n, std::vector<char>&) { ++n.splits; }), &what), std::set<CellId>{1});
  EXPECT_NE(what.find("cell 1: does not hold the splits that it says"), std::string::npos) << what;
  EXPECT_EQ(unreadable(with_lie(0, [](CellNode& n, std::vector<char>&) { --n.hidden_faces; }), &what),
            std::set<CellId>{0});
  EXPECT_EQ(unreadable(with_lie(0, [](CellNode&, std::vector<char>& p) { p.assign(p.size(), '\0'); }), &what),
            std::set<CellId>{0});
  EXPECT_NE(refusal(with_lie(2, [](CellNode& n, std::vector<char>&) { n.splits = 1'000'000; }))
                .find("cell 2: claims 1000000 splits"),
            std::string::npos);
  EXPECT_NE(refusal(with_lie(2, [](CellNode& n, std::vector<char>&) { n.payload = ~0ULL; }))
                .find("cell 2: adds what lies outside the file"),
            std::string::npos);
}

// Payloads that are coded well, but of sets that no build makes.
TEST_F(VlodFileTest, SplitsWithoutWhatTheyNeedAreRefused) {
  const auto file = open_vlod(good_, objects_);
  const CellAdditions root = file->read(0, {});
  ASSERT_GT(file->tree().nodes().size(), 1U);
  const CellAdditions* const above[] = {&root};
  const CellAdditions child = file->read(1, above);
  // Without what the root adds, some split lacks one that it needs.
  CellAdditions empty;
  empty.candidates = root.candidates;
  const CellAdditions* const nothing[] = {&empty};
  try {
    static_cast<void>(file->read(1, nothing));
    FAIL() << "the child adds nothing that needs a split of the root";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("which is not there"), std::string::npos) << error.what();
  }
  CellAdditions twice = child;
  twice.candidates = root.candidates;
  twice.objects.insert(twice.objects.end(), root.objects.begin(), root.objects.end());
  std::ranges::sort(twice.objects, {}, &ObjectAdditions::object);
  const CellAdditions* const doubled[] = {&root, &twice};
  EXPECT_THROW(static_cast<void>(file->read(1, doubled)), Error);
}

TEST_F(VlodFileTest, StaysReadableWhenItIsReplaced) {
  const auto file = open_vlod(good_, objects_);
  const std::vector<CellObjectCut> before = read_cell(*file, objects_, file->tree().leaf_of({0.3, 0.0, 0.0}));
  std::filesystem::remove(good_);
  EXPECT_EQ(read_cell(*file, objects_, file->tree().leaf_of({0.3, 0.0, 0.0}))[0].triangles, before[0].triangles);
  EXPECT_THROW(static_cast<void>(open_vlod(good_)), Error);
}

TEST_F(VlodFileTest, ATruncatedOpenFileIsAnErrorAndNoCrash) {
  const auto file = open_vlod(good_, objects_);
  std::filesystem::resize_file(good_, 100);
  EXPECT_THROW(static_cast<void>(file->read(0, {})), Error);
}

}  // namespace
}  // namespace occlod
