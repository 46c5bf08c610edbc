// Packed files: the same cells, with their geometry instead of hierarchies.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <functional>
#include <random>
#include <set>

#include "cells/packed_geometry.h"
#include "cells/vlod_format.h"
#include "occlod/base.h"
#include "occlod/build_cells.h"
#include "occlod/cell_walker.h"
#include "packed_files.h"
#include "simulated_disk.h"
#include "small_cells.h"

namespace occlod {
namespace {

using test::FileOf;
using test::sections_of;
using test::with_lie;

// The small cells, and a ball with normals and colours.
class Scene {
 public:
  Scene() {
    TriangleMesh mesh = test::noisy_sphere(4, 5);
    for (const glm::vec3& p : mesh.positions) {
      mesh.normals.push_back(glm::normalize(p));
      mesh.colors.emplace_back(static_cast<int>(100.0F + 90.0F * p.x), static_cast<int>(100.0F + 90.0F * p.y), 7, 255);
    }
    colored_ = build_hierarchy(mesh);
    const auto small = scene_.objects();
    std::ranges::copy(small, objects_.begin());
    objects_[3] = {
        .hierarchy = &colored_,
        .object_to_world = glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(0.9, 0.2, 0.0)), glm::dvec3(0.15))};
  }
  [[nodiscard]] std::span<const RefineObject> objects() const { return objects_; }

 private:
  test::SmallCells scene_;
  Hierarchy colored_;
  std::array<RefineObject, 4> objects_;
};

// Corners, and of each its normal and colour where it has any: all that is drawn of a triangle.
using Drawn = std::vector<std::array<float, 30>>;
template <typename Vertices>
Drawn drawn(std::span<const Triangle> triangles, const Vertices& vertices) {
  Drawn result;
  for (const Triangle& t : triangles) {
    std::array<float, 30>& out = result.emplace_back();
    for (int k = 0; k < 3; ++k) {
      float* at = out.data() + 10 * k;
      std::memcpy(at, &vertices.positions[t[k]], sizeof(glm::vec3));
      if (!vertices.normals.empty()) std::memcpy(at + 3, &vertices.normals[t[k]], sizeof(glm::vec3));
      for (int c = 0; c < 4 && !vertices.colors.empty(); ++c) at[6 + c] = vertices.colors[t[k]][c];
    }
  }
  std::ranges::sort(result);
  return result;
}

class PackCells : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string pattern = (std::filesystem::temp_directory_path() / "occlod-pack-XXXXXX").string();
    folder = mkdtemp(pattern.data());
    scene = std::make_unique<Scene>();
    CellTreeOptions options = test::SmallCells::options();
    options.root_cell = 0.25;
    options.max_triangles = 100;
    options.cell.tolerance_px = 0.25;  // enough for several frames
    CellBuild(scene->objects(), options).write(folder / "cells.vlod", 1);
    cells = open_vlod(folder / "cells.vlod", scene->objects());
    pack_cells(*cells, scene->objects(), folder / "packed.vlod");
    vlod::pack_cells(*cells, scene->objects(), folder / "plain.vlod", {}, 0);
    packed = open_vlod(folder / "packed.vlod");
    good = test::bytes_of_file(folder / "packed.vlod");
    plain = test::bytes_of_file(folder / "plain.vlod");
  }
  static void TearDownTestSuite() {
    cells.reset();
    packed.reset();
    std::filesystem::remove_all(folder);
    scene.reset();
  }

  // What opening a file with these bytes says; nothing if it can be opened.
  [[nodiscard]] static std::string refusal(const std::string& bytes) {
    try {
      static_cast<void>(open_vlod(FileOf(bytes).path()));
      return "";
    } catch (const Error& error) {
      return error.what();
    }
  }
  // Of what can be opened the nodes that cannot be drawn. `what`: said of the last.
  [[nodiscard]] static std::set<CellId> broken(const std::string& bytes, std::string* what = nullptr) {
    const FileOf in_memory(bytes);
    const auto file = open_vlod(in_memory.path());
    std::set<CellId> bad;
    for (CellId n = 0; n < file->tree().nodes().size(); ++n) try {
        static_cast<void>(read_cell(*file, n));
      } catch (const Error& error) {
        if (what != nullptr) *what = error.what();
        bad.insert(n);
      }
    return bad;
  }

  static inline std::filesystem::path folder;
  static inline std::unique_ptr<Scene> scene;
  static inline std::shared_ptr<const VlodFile> cells, packed;  // that with its objects, this without
  static inline std::string good, plain;                        // bytes: packed, and without compression
};

// Corner by corner, bit by bit.
TEST_F(PackCells, DrawTheSameTriangles) {
  ASSERT_TRUE(packed->is_packed() && !cells->is_packed() && !packed->has_objects());
  const FileOf uncompressed(plain);
  const auto without_codec = open_vlod(uncompressed.path());
  std::size_t leaves = 0, colored = 0;
  for (CellId n = 0; n < cells->tree().nodes().size(); ++n) {
    if (!cells->tree().is_leaf(n)) continue;
    ++leaves;
    const std::vector<CellObjectCut> expected = read_cell(*cells, scene->objects(), n);
    const std::vector<CellObjectMesh> found = read_cell(*packed, n), again = read_cell(*without_codec, n);
    ASSERT_EQ(found.size(), 4U);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const Drawn what = drawn(expected[i].triangles, scene->objects()[i].hierarchy->data());
      EXPECT_EQ(drawn(found[i].triangles, found[i]), what) << "cell " << n << ", object " << i;
      EXPECT_EQ(drawn(again[i].triangles, again[i]), what) << "cell " << n << ", object " << i;
      std::set<std::uint32_t> used;
      for (const Triangle& t : found[i].triangles) used.insert({t.x, t.y, t.z});
      EXPECT_EQ(used.size(), found[i].positions.size()) << "no vertex is there in vain";
      colored += found[i].colors.size();
    }
  }
  EXPECT_GT(leaves, 10U);
  EXPECT_GT(colored, 20U) << "or nothing is tested about attributes";
}

TEST_F(PackCells, AreTheSameCutsBesideTheirHierarchies) {
  const auto file = open_vlod(folder / "packed.vlod", scene->objects());
  EXPECT_EQ(file->key(), cells->key());
  for (CellId n = 0; n < cells->tree().nodes().size(); ++n) {
    const CellNode &node = file->tree().node(n), &before = cells->tree().node(n);
    EXPECT_EQ(node.box, before.box);
    EXPECT_EQ(node.splits, before.splits);
    EXPECT_EQ(node.hidden_faces, before.hidden_faces);
    if (!cells->tree().is_leaf(n)) continue;
    EXPECT_EQ(node.error_px, before.error_px);
    const std::vector<CellObjectCut> expected = read_cell(*cells, scene->objects(), n);
    const std::vector<CellObjectCut> found = read_cell(*file, scene->objects(), n);
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].applied, expected[i].applied);
      EXPECT_EQ(found[i].triangles, expected[i].triangles);
    }
  }
}

TEST_F(PackCells, HaveTheSameBytesWheneverTheyArePacked) {
  pack_cells(*cells, scene->objects(), folder / "again.vlod");
  EXPECT_EQ(test::bytes_of_file(folder / "again.vlod"), good);
  pack_cells(*open_vlod(folder / "plain.vlod", scene->objects()), scene->objects(), folder / "again.vlod");
  EXPECT_EQ(test::bytes_of_file(folder / "again.vlod"), good) << "from a packed file";
  EXPECT_LT(good.size(), plain.size());
}

// Old programs read files of version 1 only, and must not take these for such.
TEST_F(PackCells, AreOfAnotherVersion) {
  sections::FileHeader header;
  std::memcpy(&header, good.data(), sizeof(header));
  EXPECT_EQ(header.version, 2U);
  const std::string before = test::bytes_of_file(folder / "cells.vlod");
  std::memcpy(&header, before.data(), sizeof(header));
  EXPECT_EQ(header.version, 1U);
}

// What no cell applies is left out; what two objects share is there once.
TEST_F(PackCells, HoldWhatCellsApply) {
  std::set<std::pair<const Hierarchy*, SplitId>> applied;
  for (CellId n = 0; n < cells->tree().nodes().size(); ++n) {
    if (!cells->tree().is_leaf(n)) continue;
    const std::vector<CellObjectCut> cuts = read_cell(*cells, scene->objects(), n);
    for (std::size_t i = 0; i < cuts.size(); ++i)
      for (const SplitId s : cuts[i].applied) applied.emplace(scene->objects()[i].hierarchy, s);
  }
  EXPECT_EQ(packed->packed_counts().splits, applied.size());
  EXPECT_EQ(cells->packed_counts().splits, 0U);
  std::size_t all = 0;
  for (const std::size_t i : {0U, 1U, 3U}) all += scene->objects()[i].hierarchy->split_count();
  EXPECT_LT(applied.size(), all) << "or nothing is left out";
}

// Frame by frame beside a walk with hierarchies: the same cells at the same time, drawn alike, whatever is late.
TEST_F(PackCells, AreWalkedThroughAlike) {
  for (const bool prefetch : {true, false}) {
    CellWalker expected(cells, scene->objects(), {.loaders = 0}), found(packed, {.loaders = 0});
    expected.set_trial({.prefetch = prefetch});
    found.set_trial({.prefetch = prefetch});
    CellLoader expected_loader(expected), found_loader(found);
    std::size_t late = 0, crossed = 0;
    std::uint64_t read = 0;
    for (int i = 0; i <= 60; ++i) {
      const glm::dvec3 eye(0.12 + 0.007 * i, -0.45 + 0.014 * i, 0.2 * std::sin(0.2 * i));
      const WalkedFrame &a = expected.step(eye, 1.0 / 60.0), &b = found.step(eye, 1.0 / 60.0);
      EXPECT_EQ(b.cell, a.cell);
      EXPECT_EQ(b.shown, a.shown);
      EXPECT_EQ(b.late, a.late);
      EXPECT_EQ(b.crossed, a.crossed);
      EXPECT_EQ(b.changed, a.changed);
      EXPECT_EQ(b.drawn_triangles, a.drawn_triangles);
      EXPECT_GE(b.error_px, a.error_px) << "that of nodes that are no leaves is rounded up";
      EXPECT_NEAR(b.error_px, a.error_px, 1e-6 * a.error_px);
      for (std::size_t k = 0; k < a.objects.size(); ++k) {
        EXPECT_EQ(drawn(b.objects[k].triangles, b.objects[k]), drawn(a.objects[k].triangles, a.objects[k]));
        for (const TriangleBlock& block : b.objects[k].blocks)
          for (const Triangle& t : b.objects[k].triangles.subspan(block.first, block.count))
            for (int c = 0; c < 3; ++c) {
              const glm::vec3& p = b.objects[k].positions[t[c]];
              EXPECT_TRUE(glm::all(glm::lessThanEqual(block.box.min, p)) &&
                          glm::all(glm::lessThanEqual(p, block.box.max)));
            }
      }
      late += a.late ? 1U : 0U;
      crossed += a.crossed ? 1U : 0U;
      read += b.bytes_read;
      while (expected_loader.begin()) expected_loader.finish();
      while (found_loader.begin()) found_loader.finish();
    }
    EXPECT_GT(crossed, 3U);
    EXPECT_TRUE(prefetch ? late == 1 : late > crossed / 2) << late << " late, " << crossed << " crossings";
    EXPECT_GT(read, 1000U);
  }
}

// What a frame has handed out stays as it is for as long as it is kept, even without the walker.
TEST_F(PackCells, GiveFramesThatCanBeKept) {
  WalkedObject kept;
  std::shared_ptr<const void> owner;
  Drawn before;
  {
    CellWalker walker(packed, {.memory = 1U << 20U, .loaders = 0});
    const WalkedFrame& frame = walker.step({0.2, 0.0, 0.0}, 0.1);
    kept = frame.objects[0];
    owner = frame.owner;
    before = drawn(kept.triangles, kept);
  }
  EXPECT_FALSE(before.empty());
  EXPECT_EQ(drawn(kept.triangles, kept), before);
}

TEST_F(PackCells, KeepTheMemoryOfAWalk) {
  const auto walk = [&](std::size_t memory, const std::function<void(const WalkedFrame&)>& look) {
    WalkOptions options;
    options.loaders = 0;
    options.memory = memory;
    CellWalker walker(packed, options);
    CellLoader loader(walker);
    for (int i = 0; i <= 40; ++i) {
      const glm::dvec3 eye(0.12 + 0.01 * i, -0.45 + 0.02 * i, 0.0);
      for (int k = 0; k < 2; ++k) {
        look(walker.step(eye, 0.1));
        for (int loads = 0; loads < 50 && loader.begin(); ++loads) loader.finish();
      }
    }
  };
  std::size_t whole = 0, least = 0;
  walk(std::size_t{1} << 30U, [&](const WalkedFrame& frame) { whole = std::max(whole, frame.resident_bytes); });
  try {
    walk(1, [](const WalkedFrame&) {});
    FAIL() << "not even the base meshes fit";
  } catch (const Error& error) {
    const std::string what = error.what();
    least = std::stoul(what.substr(what.find("needs ") + 6));
  }
  ASSERT_GT(whole, 2 * least);
  ASSERT_GT(least, packed->geometry()->bytes());
  std::size_t complete = 0, incomplete = 0;
  for (std::size_t memory = least; memory < 2 * whole; memory += (whole - least) / 5)
    walk(memory, [&](const WalkedFrame& frame) {
      EXPECT_LE(frame.resident_bytes, memory);
      EXPECT_GT(frame.drawn_triangles, 0U);
      ++(frame.late ? incomplete : complete);
    });
  EXPECT_GT(complete, 0U);
  EXPECT_GT(incomplete, 0U);
}

TEST_F(PackCells, AreWalkedThroughByManyThreads) {
  CellWalker walker(packed, {.memory = 300'000, .loaders = 3});
  for (int round = 0; round < 20; ++round)
    for (int i = 0; i <= 40; ++i)
      EXPECT_GT(walker.step({0.12 + 0.01 * i, -0.45 + 0.02 * i, 0.0}, 1.0 / 60.0).drawn_triangles, 0U);
  const glm::dvec3 eye(0.3, 0.1, 0.0);
  const WalkedFrame* frame = &walker.step(eye, 0.1);
  while (frame->late && !frame->missing) frame = &walker.step(eye, 0.001);
  const std::vector<CellObjectMesh> expected = read_cell(*packed, frame->shown);
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(drawn(frame->objects[i].triangles, frame->objects[i]), drawn(expected[i].triangles, expected[i]));
}

TEST_F(PackCells, TellWhatIsReadOfThem) {
  std::uint64_t told = 0, waited = 0;
  double seconds = 0.0;
  const auto wait = tool::throttled_geometry({1e6, 0.5}, [&](double s) {
    seconds += s;
    ++waited;
  });
  CellWalker walker(packed, {.loaders = 0});
  walker.set_trial({.before_geometry = [&](std::uint64_t bytes) {
    told += bytes;
    wait(bytes);
  }});
  CellLoader loader(walker);
  walker.step({0.2, 0.0, 0.0}, 0.0);
  while (loader.begin()) loader.finish();
  const std::uint64_t read = walker.step({0.2, 0.0, 0.0}, 0.0).bytes_read;
  EXPECT_NEAR(seconds, 0.5 * static_cast<double>(waited) + 1e-6 * static_cast<double>(told), 1e-9);
  EXPECT_GT(waited, 0U);
  EXPECT_LE(told, packed->packed_counts().bytes) << "no frame is read twice while there is memory";
  EXPECT_GT(read, told) << "payloads come on top";
  EXPECT_THROW(static_cast<void>(tool::throttled_geometry({0.0, 0.0}, [](double) {})), Error);
}

// The last frame is needed by few cells: those are shown by what lies above them, others as ever.
TEST_F(PackCells, ShowAncestorsWhereTheyAreDamaged) {
  const auto frames = packed->geometry()->frames();
  ASSERT_GT(frames.size(), 2U);
  std::string bad = good;
  const std::vector<sections::Section> table = sections_of(good);
  bad[table.back().offset + frames.back().offset + 3] ^= 1;
  std::string what;
  const std::set<CellId> lost = broken(bad, &what);
  EXPECT_NE(what.find("frame " + std::to_string(frames.size() - 1) + ": is damaged: its checksum is wrong"),
            std::string::npos)
      << what;
  ASSERT_FALSE(lost.empty());
  ASSERT_FALSE(lost.contains(0));
  const FileOf in_memory(bad);
  std::size_t notes = 0;
  CellWalker walker(open_vlod(in_memory.path()), {.loaders = 0});
  CellLoader loader(walker);
  std::size_t shown = 0, missing = 0;
  for (CellId n = 0; n < packed->tree().nodes().size(); ++n) {
    if (!packed->tree().is_leaf(n)) continue;
    const CellBox& box = packed->tree().node(n).box;
    const glm::dvec3 eye = 0.5 * (box.min + box.max);
    for (int i = 0; i < 40; ++i) {
      notes += walker.step(eye, 0.1).notes.size();
      while (loader.begin()) loader.finish();
    }
    const WalkedFrame& frame = walker.step(eye, 0.0);
    EXPECT_EQ(frame.missing, lost.contains(n)) << "cell " << n;
    EXPECT_FALSE(lost.contains(frame.shown));
    EXPECT_GT(frame.drawn_triangles, 0U);
    ++(frame.late ? missing : shown);
  }
  EXPECT_GT(missing, 0U);
  EXPECT_GT(shown, 0U);
  EXPECT_GT(notes, 0U);
}

TEST_F(PackCells, CutShortAreRefused) {
  std::mt19937 random(2);
  for (std::size_t size = 0; size < good.size(); size += size < 4000 ? 1 : 1 + random() % 200)
    ASSERT_NE(refusal(good.substr(0, size)), "") << size;
}

// Every byte that counts: what opens draws either the same or an error.
TEST_F(PackCells, FlippedBytesAreFound) {
  std::size_t at_opening = 0, at_drawing = 0, unseen = 0;
  std::mt19937 random(1);
  for (std::size_t at = 0; at < good.size(); at += at < 2000 ? 5 : 1 + random() % 1500) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ (1 << (random() % 8)));
    if (!refusal(bad).empty())
      ++at_opening;
    else if (!broken(bad).empty())
      ++at_drawing;
    else
      ++unseen;
  }
  EXPECT_GT(at_opening, 200U);
  EXPECT_GT(at_drawing, 10U);
  // Section PERM, which is not read here, and padding before 14 sections.
  const auto table = sections_of(good);
  const auto permutation = std::ranges::find_if(
      table, [](const sections::Section& s) { return std::string_view(s.name.data(), 4) == vlod::permutation_name; });
  EXPECT_LT(unseen, permutation->bytes / 500 + 14 * 64 / 5);
}

// Coded well, with checksums that are right, but of what nothing makes.
TEST_F(PackCells, LiesAreFound) {
  using vlod::FrameRow;
  using vlod::MeshRow;
  using vlod::PieceRow;
  const auto refusal_of = [&]<typename T>(std::string_view name, T, const auto& lie) {
    return refusal(with_lie<T>(plain, name, [&](std::span<T> rows) { lie(rows); }));
  };
  EXPECT_EQ(refusal_of(vlod::meshes_name, MeshRow{}, [](std::span<MeshRow>) {}), "");
  const auto contains = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  const auto of_mesh = [&](const std::function<void(MeshRow&)>& lie) {
    return refusal_of(vlod::meshes_name, MeshRow{}, [&](std::span<MeshRow> rows) { lie(rows[1]); });
  };
  EXPECT_TRUE(contains(of_mesh([](MeshRow& m) { m.splits = 1U << 31U; }), "claims 2147483648 splits"));
  EXPECT_TRUE(contains(of_mesh([](MeshRow& m) { --m.splits; }), "splits that are not in their place"));
  EXPECT_TRUE(contains(of_mesh([](MeshRow& m) { ++m.base_vertices; }), "BPOS: has"));
  EXPECT_TRUE(contains(of_mesh([](MeshRow& m) { m.attributes = 8; }), "section MESH"));
  const auto of_frame = [&](const std::function<void(FrameRow&)>& lie) {
    return refusal_of(vlod::frames_name, FrameRow{}, [&](std::span<FrameRow> rows) { lie(rows[1]); });
  };
  EXPECT_TRUE(contains(of_frame([](FrameRow& f) { f.offset = ~0ULL; }), "frame 1: does not begin where"));
  EXPECT_TRUE(contains(of_frame([](FrameRow& f) { f.bytes = ~0U; }), "frame 1: lies outside the file"));
  EXPECT_TRUE(
      contains(of_frame([](FrameRow& f) { f.raw_bytes = 64 * (f.bytes + 2); }), "claims more than it can hold"));
  EXPECT_TRUE(contains(of_frame([](FrameRow& f) { f.raw_bytes = 17U << 20U; }), "claims more than it can hold"));
  EXPECT_TRUE(contains(of_frame([](FrameRow& f) { f.pieces = 0; }), "frame 1: has pieces that are not its own"));
  const auto of_piece = [&](const std::function<void(PieceRow&)>& lie) {
    return refusal_of(vlod::pieces_name, PieceRow{}, [&](std::span<PieceRow> rows) { lie(rows[1]); });
  };
  EXPECT_TRUE(contains(of_piece([](PieceRow& p) { p.mesh = 9; }), "splits that are not in their place"));
  EXPECT_TRUE(contains(of_piece([](PieceRow& p) { ++p.first; }), "splits that are not in their place"));
  EXPECT_TRUE(contains(of_piece([](PieceRow& p) { p.count = ~0U; }), "splits that are not in their place"));
  const auto of_corner = [&](std::string_view name, auto value, const auto& lie) {
    return refusal_of(name, value, [&](std::span<decltype(value)> rows) { lie(rows[0]); });
  };
  EXPECT_TRUE(contains(of_corner(vlod::base_faces_name, Triangle{}, [](Triangle& t) { t.y = 1U << 30U; }),
                       "a corner that is not there"));
  EXPECT_TRUE(contains(of_corner(vlod::base_positions_name, glm::vec3{},
                                 [](glm::vec3& p) { p.z = std::numeric_limits<float>::quiet_NaN(); }),
                       "not finite"));
  // In frames: each byte changed in turn gives another mesh, or an error, never more.
  std::mt19937 random(3);
  std::size_t refused = 0, taken = 0;
  for (int i = 0; i < 60; ++i) {
    const std::string bad = with_lie<std::byte>(plain, vlod::geometry_name, [&](std::span<std::byte> bytes) {
      bytes[random() % bytes.size()] = std::byte(random() % 256);
    });
    ++(broken(bad).empty() ? taken : refused);
  }
  EXPECT_GT(refused, 5U);
  EXPECT_GT(taken, 5U) << "other positions are as good";
}

TEST_F(PackCells, AreRefusedBesideOtherObjects) {
  std::vector<RefineObject> changed(scene->objects().begin(), scene->objects().end());
  std::swap(changed[0].hierarchy, changed[1].hierarchy);
  EXPECT_THROW(static_cast<void>(open_vlod(folder / "packed.vlod", changed)), Error);
  // A split twice in section PERM.
  const std::string bad = with_lie<std::uint32_t>(plain, vlod::permutation_name, [](std::span<std::uint32_t> numbers) {
    numbers[1] = ~0U;  // the one before again
  });
  const FileOf in_memory(bad);
  EXPECT_NO_THROW(static_cast<void>(open_vlod(in_memory.path()))) << "it is not read without objects";
  try {
    static_cast<void>(open_vlod(in_memory.path(), scene->objects()));
    FAIL() << "it numbers no splits";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("section PERM: does not number the splits of object 0"), std::string::npos)
        << error.what();
  }
}

TEST_F(PackCells, SayWhatTheyAreNotFor) {
  EXPECT_THROW(static_cast<void>(read_cell(*cells, 0)), Error);
  EXPECT_THROW(CellWalker{cells}, Error) << "it was opened with objects";
  EXPECT_THROW(CellWalker{open_vlod(folder / "cells.vlod")}, Error) << "it has no geometry";
  EXPECT_THROW(CellWalker{open_vlod(folder / "packed.vlod", scene->objects())}, Error);
  CellWalker beside(open_vlod(folder / "packed.vlod", scene->objects()), scene->objects(), {.loaders = 0});
  EXPECT_GT(beside.step({0.2, 0.0, 0.0}, 0.0).drawn_triangles, 0U);
  EXPECT_THROW(pack_cells(*packed, scene->objects(), folder / "x.vlod"), Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "x.vlod"));
}

TEST_F(PackCells, CancellingLeavesTheOldFile) {
  const std::filesystem::path path = folder / "packed.vlod";
  for (const int most : {0, 1, 20}) {
    int calls = 0;
    EXPECT_THROW(pack_cells(*cells, scene->objects(), path, [&](double) { return calls++ < most; }), Error);
    EXPECT_EQ(calls, most + 1);
    EXPECT_EQ(test::bytes_of_file(path), good);
  }
  double last = -1.0;
  pack_cells(*cells, scene->objects(), folder / "again.vlod", [&](double done) {
    EXPECT_GE(done, last);
    last = done;
    return true;
  });
  EXPECT_EQ(last, 1.0);
}

}  // namespace
}  // namespace occlod
