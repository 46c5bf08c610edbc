// Builds that go on from a journal.
#include <gtest/gtest.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "base/platform.h"
#include "build_story.h"
#include "hlod/build/build_journal.h"
#include "hlod_bytes.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/generate.h"
#include "support/meshes.h"
#include "support/wedge_meshes.h"

namespace occlod::hlod {
namespace {

constexpr std::size_t header_bytes = 120, head_bytes = 24;  // of the file, and of each node

std::vector<Story> stories() {
  return {story("shifted", occlod::test::noisy_sphere(5, 1)),
          story("nested", occlod::test::noisy_sphere(4, 2), [](HlodBuildOptions& o) { o.grouping = Grouping::nested; }),
          story("free", occlod::test::noisy_sphere(4, 3),
                [](HlodBuildOptions& o) {
                  o.grouping = Grouping::nested;
                  o.borders = Borders::free;
                }),
          story("splits", occlod::test::noisy_sphere(4, 4), [](HlodBuildOptions& o) { o.within = Within::splits; }),
          story("wedges", occlod::test::book(40)),
          story("charts", occlod::test::cube_of_charts(14)),
          story("charts with splits", occlod::test::cube_of_charts(12),
                [](HlodBuildOptions& o) { o.within = Within::splits; })};
}

class Journal : public testing::Test {
 protected:
  Journal() { std::filesystem::remove(path_); }
  ~Journal() override { std::filesystem::remove(path_); }
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  [[nodiscard]] std::string content() const {
    std::ifstream stream(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }
  void write(const std::string& content) const {
    std::filesystem::remove(path_);  // some file systems write to the disk at once what is written over
    std::ofstream(path_, std::ios::binary) << content;
  }

  // The bytes of the HLOD; taken() is what the journal had.
  std::string build(const TriangleMesh& mesh, HlodBuildOptions options, int threads = 0) {
    options.journal = path_;
    options.threads = threads;
    MeshReport report;
    return test::bytes_of(build_hlod(mesh, options, report, taken_));
  }
  [[nodiscard]] std::size_t taken() const { return taken_; }

  std::string refusal(const TriangleMesh& mesh, const HlodBuildOptions& options) {
    try {
      (void)build(mesh, options);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

 private:
  std::filesystem::path path_ = testing::TempDir() + "journal_test." + std::to_string(process_id());
  std::size_t taken_ = 0;
};

// Where a record begins and ends, and how many nodes lie before its end.
struct Record {
  std::size_t begin = 0, end = 0;
  std::size_t nodes = 0;
  bool is_node = false;
};

std::uint32_t number_at(const std::string& journal, std::size_t place) {
  std::uint32_t number = 0;
  std::memcpy(&number, journal.data() + place, sizeof(number));
  return number;
}

// Of a whole journal of a build of so many triangles. Each level has the number of groups, the group of each triangle
// in pieces, and, but for the input, as many nodes, which tell their triangles after 32 other bytes.
std::vector<Record> records_in(const std::string& journal, std::size_t triangles) {
  constexpr std::size_t max_in_piece = 1U << 18U;
  std::vector<Record> records;
  const auto next = [&](bool is_node) {
    const std::size_t begin = records.empty() ? header_bytes : records.back().end;
    const std::size_t nodes = records.empty() ? 0 : records.back().nodes;
    records.push_back({begin, begin + head_bytes + number_at(journal, begin), nodes + (is_node ? 1U : 0U), is_node});
  };
  for (bool is_input = true; records.empty() || records.back().end < journal.size(); is_input = false) {
    next(false);
    const std::uint32_t groups = number_at(journal, records.back().begin + head_bytes);
    for (std::size_t t = 0; t < triangles; t += max_in_piece) next(false);
    if (is_input) continue;
    triangles = 0;
    for (std::uint32_t n = 0; n < groups; ++n) {
      next(true);
      triangles += number_at(journal, records.back().begin + head_bytes + 32);
    }
  }
  EXPECT_EQ(records.back().end, journal.size());
  return records;
}

// In so many bytes of the journal.
std::size_t whole_nodes(const std::vector<Record>& records, std::size_t bytes) {
  std::size_t nodes = 0;
  for (const Record& record : records)
    if (record.end <= bytes) nodes = record.nodes;
  return nodes;
}

std::size_t nodes_above_input(const TriangleMesh& mesh, const HlodBuildOptions& options) {
  const Hlod hlod = build_hlod(mesh, options);
  return hlod.node_count() - hlod.data().levels[0].node_count;
}

TEST_F(Journal, IsTakenOverAsAWhole) {
  for (const auto& [name, mesh, options] : stories()) {
    SCOPED_TRACE(name);
    const std::string plain = test::bytes_of(build_hlod(mesh, options));
    EXPECT_EQ(build(mesh, options), plain);
    EXPECT_EQ(taken(), 0U);
    const std::string whole = content();
    // There is a node for each that had to be simplified, and perhaps a level that was left out.
    const std::size_t nodes = records_in(whole, mesh.triangle_count()).back().nodes;
    EXPECT_GE(nodes, nodes_above_input(mesh, options));
    EXPECT_EQ(build(mesh, options), plain);
    EXPECT_EQ(taken(), nodes);
    EXPECT_EQ(content(), whole);
    std::filesystem::remove(path());
  }
}

// Each build is cancelled one callback later than the one before, until one ends.
TEST_F(Journal, BuildsCancelledAtAnyMomentGoOn) {
  std::size_t all_cancelled = 0, all_taken = 0;
  for (const auto& [name, mesh, options] : stories()) {
    SCOPED_TRACE(name);
    const std::string plain = test::bytes_of(build_hlod(mesh, options));
    std::size_t cancelled = 0, bytes_before = 0;
    std::string resumed;
    while (resumed.empty()) {
      std::size_t calls = 0;
      HlodBuildOptions cancelling = options;
      cancelling.progress = [&](double) { return calls++ < cancelled; };
      const std::string before = content();
      bytes_before = before.size();
      try {
        resumed = build(mesh, cancelling, 1 + static_cast<int>(cancelled % 3));
      } catch (const Error& error) {
        ASSERT_NE(std::string(error.what()).find("was cancelled"), std::string::npos) << error.what();
        ++cancelled;
      }
      EXPECT_TRUE(content().starts_with(before)) << "nothing is lost";
    }
    EXPECT_EQ(resumed, plain);
    EXPECT_EQ(taken(), whole_nodes(records_in(content(), mesh.triangle_count()), bytes_before));
    all_cancelled += cancelled;
    all_taken += taken();
    std::filesystem::remove(path());
  }
  // Calls come when a level begins, and more of them where that takes long.
  EXPECT_GT(all_cancelled, 15U);
  EXPECT_GT(all_taken, 100U);
}

TEST_F(Journal, IsUsedAsFarAsItIsWhole) {
  for (const auto& [name, mesh, options] : stories()) {
    const std::string plain = build(mesh, options);
    const std::string whole = content();
    const std::vector<Record> records = records_in(whole, mesh.triangle_count());
    std::vector<std::size_t> cuts = {0, 1, 8, 9, header_bytes - 1, header_bytes, whole.size() - 1, whole.size()};
    // The groups of the input and of the next level, its first nodes, some on the way, the last ones.
    for (const std::size_t record : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{4},
                                     records.size() / 2, records.size() - 1})
      for (const std::size_t more : {std::size_t{0}, head_bytes - 1, head_bytes, head_bytes + 3})
        cuts.push_back(records[record].begin + more);
    for (const std::size_t cut : cuts) {
      write(whole.substr(0, cut));
      EXPECT_EQ(build(mesh, options, 2), plain) << name << " cut at " << cut;
      EXPECT_EQ(taken(), whole_nodes(records, cut)) << name << " cut at " << cut;
      EXPECT_EQ(content(), whole) << name << " cut at " << cut;
    }
    std::filesystem::remove(path());
  }
}

TEST_F(Journal, DamageEndsIt) {
  std::mt19937 random(1);
  for (const auto& [name, mesh, options] : stories()) {
    const std::string plain = build(mesh, options);
    const std::string whole = content();
    const std::vector<Record> records = records_in(whole, mesh.triangle_count());
    for (int i = 0; i < 20; ++i) {
      // Every third in the head of a record, which says how long it is; some in the header.
      std::size_t at = std::uniform_int_distribution<std::size_t>(8, whole.size() - 1)(random);
      if (i % 3 == 0)
        at = records[at % records.size()].begin + at % head_bytes;
      else if (i % 10 == 1)
        at = 8 + at % (header_bytes - 8);
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << (i % 8)));
      write(damaged);
      EXPECT_EQ(build(mesh, options), plain) << name << " damaged at " << at;
      EXPECT_EQ(taken(), whole_nodes(records, at)) << name << " damaged at " << at;
      EXPECT_EQ(content(), whole) << name << " damaged at " << at;
    }
    std::filesystem::remove(path());
  }
}

TEST_F(Journal, NodesKeepTheirOrder) {
  const Story story = stories()[0];
  const std::string plain = build(story.mesh, story.options);
  const std::string whole = content();
  const std::vector<Record> records = records_in(whole, story.mesh.triangle_count());
  const auto first_node = static_cast<std::size_t>(
      std::find_if(records.begin(), records.end(), [](const Record& r) { return r.is_node; }) - records.begin());
  ASSERT_TRUE(records[first_node + 7].is_node);
  // Nodes of the first level.
  const auto nodes = [&](std::size_t first, std::size_t end) {
    const std::size_t begin = records[first_node + first].begin;
    return whole.substr(begin, records[first_node + end].begin - begin);
  };
  const std::string header = whole.substr(0, header_bytes), before = whole.substr(0, records[first_node].begin),
                    rest = whole.substr(records[first_node + 7].begin);
  for (const std::string& changed :
       {before + nodes(0, 5) + nodes(6, 7) + rest, before + nodes(0, 5) + nodes(4, 7) + rest,
        before + nodes(0, 5) + nodes(6, 7) + nodes(5, 6) + rest}) {
    write(changed);
    EXPECT_EQ(build(story.mesh, story.options), plain);
    EXPECT_EQ(taken(), 5U);
    EXPECT_EQ(content(), whole);
  }
  // One of another build, in the same place.
  HlodBuildOptions other = story.options;
  other.grouping = Grouping::nested;
  std::filesystem::remove(path());
  (void)build(story.mesh, other);
  const std::string theirs = content();
  write(header + theirs.substr(header_bytes));
  EXPECT_EQ(build(story.mesh, story.options), plain);
  EXPECT_EQ(taken(), 0U);
}

TEST_F(Journal, OtherOptionsAreRefused) {
  const TriangleMesh mesh = occlod::test::noisy_sphere(4, 1);
  HlodBuildOptions options;
  options.node_triangles = 32;
  options.grouping = Grouping::nested;
  (void)build(mesh, options);
  const std::string whole = content();
  const auto expect_refused = [&](const char* message, const std::function<void(HlodBuildOptions&)>& change) {
    HlodBuildOptions other = options;
    change(other);
    EXPECT_EQ(refusal(mesh, other), path().string() + ": option " + message +
                                        " in this one; build with the same, or remove the journal to start anew");
    EXPECT_EQ(content(), whole);
  };
  expect_refused("node_triangles: is 32 in the build that left the journal, 33",
                 [](HlodBuildOptions& o) { o.node_triangles = 33; });
  expect_refused("grouping: is nested in the build that left the journal, shifted",
                 [](HlodBuildOptions& o) { o.grouping = Grouping::shifted; });
  expect_refused("borders: is locked in the build that left the journal, free",
                 [](HlodBuildOptions& o) { o.borders = Borders::free; });
  expect_refused("within: is geomorph in the build that left the journal, splits",
                 [](HlodBuildOptions& o) { o.within = Within::splits; });
}

TEST_F(Journal, AnotherMeshIsRefused) {
  const TriangleMesh mesh = occlod::test::cube_of_charts(8);
  HlodBuildOptions options;
  options.node_triangles = 16;
  (void)build(mesh, options);
  const std::string whole = content();
  const auto expect_refused = [&](const std::function<void(TriangleMesh&)>& change) {
    TriangleMesh other = mesh;
    change(other);
    const std::string told = refusal(other, options);
    EXPECT_NE(told.find("is the journal of another mesh"), std::string::npos) << told;
    EXPECT_EQ(content(), whole);
  };
  expect_refused([](TriangleMesh& m) {
    for (glm::vec3& p : m.positions) p.x += 0.001F;
  });
  expect_refused(
      [](TriangleMesh& m) { std::swap(m.triangles[3], m.triangles[4]), std::swap(m.corners[3], m.corners[4]); });
  expect_refused([](TriangleMesh& m) { m.texture_coordinates[3].x += 0.001F; });
  expect_refused([](TriangleMesh& m) { m.normals.assign(m.wedge_count(), glm::vec3(0.0F, 0.0F, 1.0F)); });
  expect_refused([](TriangleMesh& m) { m.colors.assign(m.wedge_count(), glm::u8vec4(9)); });
  expect_refused([](TriangleMesh& m) {
    m.materials.resize(2);
    m.triangle_materials.assign(m.triangle_count(), 1);
  });
  (void)build(mesh, options);
  EXPECT_GT(taken(), 0U);
}

TEST_F(Journal, OfAnotherVersionIsRefused) {
  const TriangleMesh mesh = occlod::test::noisy_sphere(3, 1);
  HlodBuildOptions options;
  options.node_triangles = 16;
  (void)build(mesh, options);
  std::string older = content();
  older[8] = 'x';
  const std::uint64_t checksum = XXH3_64bits(older.data(), header_bytes - 8);
  std::memcpy(older.data() + header_bytes - 8, &checksum, sizeof(checksum));
  write(older);
  EXPECT_EQ(refusal(mesh, options),
            path().string() + ": is the journal of another version of this program; remove it to start anew");
  EXPECT_EQ(content(), older);
}

TEST_F(Journal, AnotherFileIsNotTouched) {
  const TriangleMesh mesh = occlod::test::noisy_sphere(3, 1);
  for (const std::string& text : {std::string("x"), std::string("ply\nformat ascii 1.0\n"), std::string(500, 'O')}) {
    write(text);
    EXPECT_EQ(refusal(mesh, {}), path().string() + ": is not a journal of an HLOD build; move it away");
    EXPECT_EQ(content(), text);
  }
}

TEST_F(Journal, OneBuildAtATime) {
  const TriangleMesh mesh = occlod::test::noisy_sphere(3, 1);
  (void)build(mesh, {});
  {
    const JournalFile other(path().c_str());
    EXPECT_EQ(refusal(mesh, {}), path().string() + ": another build uses it; wait until that has ended");
  }
  EXPECT_EQ(refusal(mesh, {}), "");
}

TEST_F(Journal, IsNotMadeForAMeshThatCannotBeBuilt) {
  TriangleMesh mesh = occlod::test::noisy_sphere(3, 1);
  mesh.triangles[0].x = 1'000'000;
  EXPECT_NE(refusal(mesh, {}), "");
  EXPECT_FALSE(std::filesystem::exists(path()));
}

TEST_F(Journal, AFolderThatIsNotThereIsTold) {
  HlodBuildOptions options;
  options.journal = path() / "none";
  try {
    (void)build_hlod(occlod::test::noisy_sphere(3, 1), options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.diagnosis().subject, options.journal.string());
    EXPECT_NE(error.diagnosis().problem.find("cannot be opened"), std::string::npos);
  }
}

// The arrays lie in files, then in memory, and half of the journal is there.
TEST_F(Journal, MemoryMayDiffer) {
  const TriangleSource planet = [](TriangleSink& sink) {
    stream_generated("rough-planet", {{"level", 8}}, [&](const TriangleMesh& piece, std::size_t) { sink.add(piece); });
  };
  std::size_t found = 0;
  HlodBuildOptions options;
  options.node_triangles = 64;
  MeshReport report;
  const std::string plain = test::bytes_of(build_hlod(planet, options, report));
  options.journal = path();
  {
    const MemoryLimit limit(std::size_t{64} << 20U, testing::TempDir());
    EXPECT_EQ(test::bytes_of(build_hlod(planet, options, report, found)), plain);
    EXPECT_GT(limit.max_scratch_bytes(), std::size_t{20} << 20U);
  }
  const std::string whole = content();
  const std::vector<Record> records = records_in(whole, 8U << 16U);
  ASSERT_FALSE(records[4].is_node) << "the groups of the input, 2^19 triangles, take two pieces and the number";
  for (const std::size_t bytes : {records[2].end - 100, records[5].end - 100, whole.size() / 2, whole.size() / 4 * 3}) {
    std::filesystem::resize_file(path(), bytes);
    EXPECT_EQ(test::bytes_of(build_hlod(planet, options, report, found)), plain);
    EXPECT_EQ(found, whole_nodes(records, bytes));
    EXPECT_EQ(content(), whole);
    std::filesystem::resize_file(path(), bytes);
    const MemoryLimit limit(std::size_t{64} << 20U, testing::TempDir());
    EXPECT_EQ(test::bytes_of(build_hlod(planet, options, report, found)), plain);
    EXPECT_EQ(found, whole_nodes(records, bytes));
    EXPECT_EQ(content(), whole);
  }
  EXPECT_GT(found, 1000U);
}

}  // namespace
}  // namespace occlod::hlod
