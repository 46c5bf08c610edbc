#include "occlod/cell_walker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <mutex>
#include <set>
#include <system_error>
#include <thread>
#include <tuple>

#include "occlod/base.h"
#include "occlod/build_cells.h"
#include "occlod/build_hierarchy.h"
#include "occlod/picture.h"
#include "simulated_disk.h"
#include "small_cells.h"

namespace occlod {
namespace {

std::vector<Triangle> sorted(std::span<const Triangle> triangles) {
  std::vector<Triangle> result(triangles.begin(), triangles.end());
  std::ranges::sort(result, {}, [](const Triangle& t) { return std::tuple(t.x, t.y, t.z); });
  return result;
}

// A path from the corner of one region to the other, in steps of that many world units.
std::vector<glm::dvec3> walk_in(const CellBox& region, double step) {
  std::vector<glm::dvec3> eyes;
  const glm::dvec3 way = region.max - region.min;
  for (double done = 0.0; done <= 1.0; done += step / glm::length(way)) eyes.push_back(region.min + done * way);
  return eyes;
}

class CellWalkerTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const std::filesystem::path folder = make_folder();
    const test::SmallCells scene;
    CellBuild(scene.objects(), walk_options()).write(folder / "cells.vlod", 1);
    file_bytes = test::bytes_of_file(folder / "cells.vlod");
    std::filesystem::remove_all(folder);
  }
  void SetUp() override {
    folder_ = make_folder();
    path_ = folder_ / "cells.vlod";
    std::ofstream(path_, std::ios::binary) << file_bytes;
    file_ = open_vlod(path_, objects_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] static std::filesystem::path make_folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "occlod-walk-XXXXXX").string();
    return mkdtemp(pattern.data());
  }
  [[nodiscard]] static CellTreeOptions walk_options() {
    CellTreeOptions options = test::SmallCells::options();
    options.root_cell = 0.25;
    options.max_triangles = 100;
    return options;
  }
  [[nodiscard]] static WalkOptions by_hand() { return {.loaders = 0}; }
  static void load_all(CellLoader& loader) {
    while (loader.begin()) loader.finish();
  }
  // That it is what the file has for the node: of a leaf what read_cell() gives; of another node it is drawn no matter
  // what is hidden below.
  void expect_cut_of(const WalkedFrame& frame, CellId leaf) {
    EXPECT_EQ(frame.shown, leaf);
    const std::vector<CellObjectCut> cuts = read_cell(*file_, objects_, leaf);
    for (std::size_t i = 0; i < cuts.size(); ++i)
      EXPECT_EQ(sorted(frame.objects[i].triangles), sorted(cuts[i].triangles)) << "cell " << leaf << ", object " << i;
  }
  // Whatever happens, something is drawn, it is of a node on the path to the eye, and memory is kept.
  void expect_sound(const WalkedFrame& frame, std::size_t memory) {
    notes_.insert(notes_.end(), frame.notes.begin(), frame.notes.end());
    EXPECT_GT(frame.drawn_triangles, 0U);
    EXPECT_LE(frame.resident_bytes, memory);
    EXPECT_EQ(file_->tree().common_ancestor(frame.shown, frame.cell), frame.shown);
    EXPECT_EQ(frame.late, frame.shown != frame.cell);
    std::size_t triangles = 0;
    for (const WalkedObject& object : frame.objects) {
      triangles += object.triangles.size();
      std::uint32_t next = 0;
      for (const TriangleBlock& block : object.blocks) {
        EXPECT_EQ(block.first, next);
        next += block.count;
      }
      EXPECT_EQ(next, object.triangles.size());
    }
    EXPECT_EQ(frame.drawn_triangles, triangles);
  }

  test::SmallCells scene_;
  std::array<RefineObject, 3> objects_ = scene_.objects();
  CellTreeOptions options_ = walk_options();
  static inline std::string file_bytes;  // all tests walk through the same
  std::filesystem::path folder_, path_;
  std::shared_ptr<const VlodFile> file_;
  std::vector<std::string> notes_;
};

TEST_F(CellWalkerTest, DrawsTheCutOfEachCell) {
  CellWalker walker(file_, objects_, by_hand());
  CellLoader loader(walker);
  std::set<CellId> cells;
  CellId before = no_id;
  for (const CellBox& region : options_.regions)
    for (const glm::dvec3& eye : walk_in(region, 0.05)) {
      walker.step(eye, 0.1);
      load_all(loader);
      const WalkedFrame& frame = walker.step(eye, 0.1);
      expect_sound(frame, WalkOptions().memory);
      EXPECT_EQ(frame.cell, file_->tree().leaf_of(eye)) << "the lowest id on a border";
      EXPECT_FALSE(frame.late || frame.missing || frame.outside || frame.crossed);
      EXPECT_EQ(frame.error_px, static_cast<double>(file_->tree().node(frame.cell).error_px));
      if (frame.cell != before) expect_cut_of(frame, frame.cell);
      cells.insert(before = frame.cell);
    }
  EXPECT_GT(cells.size(), 6U);
  EXPECT_TRUE(notes_.empty());
}

TEST_F(CellWalkerTest, HasNeighboursAndWhatIsAheadBeforeTheyAreEntered) {
  const CellBox& region = options_.regions[0];
  for (const double speed : {0.05, 0.5, 3.0}) {  // cells are 0.125 to 0.25
    CellWalker walker(file_, objects_, by_hand());
    CellLoader loader(walker);
    walker.step(region.min, 0.0);
    load_all(loader);
    std::size_t crossed = 0;
    for (const glm::dvec3& eye : walk_in(region, speed / 60.0)) {
      const WalkedFrame& frame = walker.step(eye, 1.0 / 60.0);
      crossed += frame.crossed ? 1U : 0U;
      EXPECT_FALSE(frame.late) << "cell " << frame.cell;
      load_all(loader);
    }
    EXPECT_GE(crossed, 3U);
  }
}

// Where there is no time for all neighbours, the way ahead counts, though others are nearer.
TEST_F(CellWalkerTest, LoadsWhatIsAheadBeforeWhatIsAside) {
  CellWalker walker(file_, objects_, by_hand());
  std::vector<CellId> leaves;  // as they were read
  walker.set_trial({.reader = [&](CellId cell, std::span<const CellAdditions* const> above) {
    if (file_->tree().is_leaf(cell)) leaves.push_back(cell);
    return file_->read(cell, above);
  }});
  CellLoader loader(walker);
  const CellId here = file_->tree().leaf_of(options_.regions[0].min);
  const CellBox& box = file_->tree().node(here).box;
  const double edge = box.max.y - box.min.y;
  const glm::dvec3 middle = 0.5 * (box.min + box.max), eye(middle.x, box.min.y + 0.05 * edge, middle.z);
  for (int i = 60; i >= 0; --i) walker.step(eye - glm::dvec3(0.0, 0.1 * i, 0.0), 0.01);
  load_all(loader);
  ASSERT_GE(leaves.size(), 2U);
  EXPECT_EQ(leaves[0], here);
  EXPECT_EQ(leaves[1], file_->tree().leaf_of({middle.x, box.max.y + 0.01 * edge, middle.z}));
}

// The control: what makes frames late, and what is drawn in them.
TEST_F(CellWalkerTest, IsLateWithoutPrefetch) {
  const WalkOptions options = by_hand();
  CellWalker walker(file_, objects_, options);
  walker.set_trial({.prefetch = false});
  CellLoader loader(walker);
  std::size_t late = 0, crossed = 0;
  for (const glm::dvec3& eye : walk_in(options_.regions[0], 0.01)) {
    const WalkedFrame& frame = walker.step(eye, 1.0 / 60.0);
    expect_sound(frame, options.memory);
    late += frame.late ? 1U : 0U;
    crossed += frame.crossed ? 1U : 0U;
    if (frame.late) {
      EXPECT_FALSE(frame.missing);
      EXPECT_GT(frame.error_px, options_.cell.tolerance_px) << "and it says so";
    }
    load_all(loader);
  }
  EXPECT_EQ(late, crossed + 1) << "the frame of each crossing, and the first";
}

// A disk that is simulated frame by frame: as much as fits into the time of a frame is done in it.
TEST_F(CellWalkerTest, IsInTimeOnADiskThatIsFastEnough) {
  const auto late_frames = [&](double latency, bool prefetch) {
    double clock = 0.0, now = 0.0;
    CellWalker walker(file_, objects_, by_hand());
    walker.set_trial(
        {.reader = tool::throttled(
             [&](CellId cell, std::span<const CellAdditions* const> above) { return file_->read(cell, above); }, *file_,
             {1e6, latency}, [&](double seconds) { clock += seconds; }),
         .prefetch = prefetch});
    CellLoader loader(walker);
    bool under_way = false;
    std::size_t late = 0;
    const std::vector<glm::dvec3> eyes = walk_in(options_.regions[0], 0.005);
    for (std::size_t i = 0; i < eyes.size() + 60; ++i) {
      const WalkedFrame& frame = walker.step(eyes[i < 60 ? 0 : i - 60], 1.0 / 60.0);  // a second to begin with
      late += i >= 60 && frame.late ? 1U : 0U;
      now += 1.0 / 60.0;
      while (clock <= now) {
        if (under_way) loader.finish();
        clock = std::max(clock, now - 1.0 / 60.0);
        under_way = loader.begin();
        if (!under_way) break;
      }
    }
    return late;
  };
  EXPECT_EQ(late_frames(0.005, true), 0U);
  EXPECT_GT(late_frames(0.005, false), 0U);
  EXPECT_GT(late_frames(2.0, true), 0U) << "nothing helps against a disk that takes seconds";
}

TEST_F(CellWalkerTest, ShowsWhatLiesAboveUntilACellIsThere) {
  CellWalker walker(file_, objects_, by_hand());
  CellLoader loader(walker);
  const CellTree& tree = file_->tree();
  const CellBox& region = options_.regions[0];
  walker.step(region.min, 0.1);
  load_all(loader);
  const WalkedFrame& here = walker.step(region.min, 0.1);
  ASSERT_FALSE(here.late);
  const CellId first = here.cell;
  // Nothing is loaded any more: each cell shows the deepest node above it that the first one has too, or that was
  // loaded as a neighbour.
  std::set<CellId> shown;
  for (const glm::dvec3& eye : walk_in(region, 0.05)) {
    const WalkedFrame& frame = walker.step(eye, 1.0);
    expect_sound(frame, WalkOptions().memory);
    if (!frame.late) continue;
    shown.insert(frame.shown);
    EXPECT_FALSE(tree.is_leaf(frame.shown));
    EXPECT_GE(tree.node(frame.shown).level, tree.node(tree.common_ancestor(first, frame.cell)).level);
    // All its splits are drawn, whatever leaves hide: the faces of these that do not turn away.
    std::vector<CellId> path;
    tree.path_to(frame.shown, path);
    std::vector<CellAdditions> additions;
    std::vector<const CellAdditions*> above;
    additions.reserve(path.size());
    std::array<FixedCut, 3> cuts;
    for (std::size_t i = 0; i < 3; ++i) cuts[i].applied.resize(objects_[i].hierarchy->split_count());
    for (const CellId node : path) {
      above.push_back(&additions.emplace_back(file_->read(node, above)));
      for (const ObjectAdditions& object : above.back()->objects)
        for (const SplitId s : object.splits) cuts[object.object].applied[s] = true;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      cuts[i].triangles = objects_[i].hierarchy->face_count();
      std::vector<Triangle> expected = triangles_of(*objects_[i].hierarchy, cuts[i]);
      const CellView view(tree.node(frame.shown).box, options_.cell.eyes, objects_[i].object_to_world);
      const auto p = objects_[i].hierarchy->positions();
      if (!objects_[i].two_sided)
        std::erase_if(expected, [&](const Triangle& t) { return view.faces_away(p[t.x], p[t.y], p[t.z]); });
      EXPECT_EQ(sorted(frame.objects[i].triangles), sorted(expected)) << "node " << frame.shown << ", object " << i;
    }
  }
  EXPECT_FALSE(shown.empty());
}

TEST_F(CellWalkerTest, KeepsItsMemory) {
  std::size_t root = 0, whole = 0;
  {
    CellWalker walker(file_, objects_, by_hand());
    root = walker.step({9, 9, 9}, 0.1).resident_bytes;
    CellLoader loader(walker);
    for (const glm::dvec3& eye : walk_in(options_.regions[0], 0.05)) {
      walker.step(eye, 0.1);
      load_all(loader);
    }
    whole = walker.step({9, 9, 9}, 0.1).resident_bytes;
  }
  ASSERT_GT(whole, 4 * root);
  WalkOptions options = by_hand();
  options.memory = root - 1;
  try {
    const CellWalker walker(file_, objects_, options);
    FAIL() << "it needs more";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(std::to_string(root)), std::string::npos) << error.what();
  }
  // From what holds hardly more than the root to nearly all.
  std::size_t complete = 0, incomplete = 0;
  for (std::size_t memory = root; memory < whole; memory += (whole - root) / 6) {
    options.memory = memory;
    CellWalker walker(file_, objects_, options);
    CellLoader loader(walker);
    for (const glm::dvec3& eye : walk_in(options_.regions[0], 0.02)) {
      expect_sound(walker.step(eye, 0.1), memory);
      // Not all that is wanted: what is loaded counts even before the next step, and it must end.
      for (int i = 0; i < 50 && loader.begin(); ++i) loader.finish();
      const WalkedFrame& frame = walker.step(eye, 0.0);
      expect_sound(frame, memory);
      ++(frame.late ? incomplete : complete);
      EXPECT_EQ(frame.missing, frame.late) << "what does not fit never comes";
      if (memory == root) {
        EXPECT_EQ(frame.shown, 0U);
      }
    }
  }
  EXPECT_GT(complete, 0U);
  EXPECT_GT(incomplete, 0U);
  ASSERT_FALSE(notes_.empty());
  EXPECT_NE(notes_[0].find("needs"), std::string::npos) << notes_[0];
  EXPECT_EQ(std::set<std::string>(notes_.begin(), notes_.end()).size(), notes_.size()) << "each line once";
}

TEST_F(CellWalkerTest, DrawsSomethingInEachFrameWhereverTheEyeIs) {
  WalkOptions options = by_hand();
  CellWalker walker(file_, objects_, options);
  CellLoader loader(walker);
  const CellTree& tree = file_->tree();
  // From leaf to leaf in each frame, one load a frame.
  for (CellId n = 0; n < tree.nodes().size(); ++n) {
    if (!tree.is_leaf(n)) continue;
    const WalkedFrame& frame = walker.step(0.5 * (tree.node(n).box.min + tree.node(n).box.max), 1.0 / 60.0);
    expect_sound(frame, options.memory);
    EXPECT_EQ(frame.cell, n);
    if (loader.begin()) loader.finish();
  }
  // 300 units a second, through all cells and out.
  for (double x = -30.0; x < 30.0; x += 5.0) {
    const WalkedFrame& frame = walker.step({x, 0.0, 0.0}, 1.0 / 60.0);
    expect_sound(frame, options.memory);
    EXPECT_TRUE(frame.outside);
    EXPECT_EQ(frame.cell, tree.nearest_leaf({x, 0.0, 0.0}));
    if (loader.begin()) loader.finish();
  }
}

// Reads of one cell fail so many times.
TEST_F(CellWalkerTest, TriesAgainAfterErrorsOfTheDisk) {
  const CellTree& tree = file_->tree();
  const glm::dvec3 eye = options_.regions[0].min;
  const CellId bad = tree.leaf_of(eye);
  for (const int failures : {1, 2, 3, 1000}) {
    notes_.clear();
    int left = failures, reads = 0;
    const WalkOptions options = by_hand();
    CellWalker walker(file_, objects_, options);
    walker.set_trial({.reader = [&](CellId cell, std::span<const CellAdditions* const> above) {
      reads += cell == bad ? 1 : 0;
      if (cell == bad && left-- > 0)
        throw Error({"cells.vlod", "cell", "cannot be read: Input/output error", "check the disk"});
      return file_->read(cell, above);
    }});
    CellLoader loader(walker);
    bool shown = false, missing = false;
    for (int i = 0; i < 100; ++i) {
      const WalkedFrame& frame = walker.step(eye, 0.1);
      expect_sound(frame, options.memory);
      shown = !frame.late;
      missing = frame.missing;
      load_all(loader);
    }
    EXPECT_EQ(shown, failures < 3);
    EXPECT_EQ(missing, failures >= 3);
    EXPECT_EQ(reads, std::min(failures + 1, 3)) << "once a second, three times";
    EXPECT_EQ(notes_.size(), static_cast<std::size_t>(std::min(failures, 3)));
    EXPECT_NE(notes_[0].find("Input/output error"), std::string::npos);
  }
}

// What lies above a damaged node is shown in its place.
TEST_F(CellWalkerTest, GoesOnWithADamagedFile) {
  const CellTree& tree = file_->tree();
  const glm::dvec3 eye = options_.regions[0].max;
  const CellId bad = tree.node(tree.leaf_of(eye)).parent;
  ASSERT_NE(bad, 0U) << "a node between root and leaf";
  const WalkOptions options = by_hand();
  CellWalker walker(file_, objects_, options);
  walker.set_trial({.reader = [&](CellId cell, std::span<const CellAdditions* const> above) {
    if (cell == bad) throw std::system_error(std::make_error_code(std::errc::io_error));
    return file_->read(cell, above);
  }});
  CellLoader loader(walker);
  for (int i = 0; i < 40; ++i) {
    const WalkedFrame& frame = walker.step(eye, 0.1);
    expect_sound(frame, options.memory);
    EXPECT_TRUE(frame.late);
    EXPECT_EQ(tree.common_ancestor(frame.shown, bad), frame.shown);
    EXPECT_NE(frame.shown, bad);
    load_all(loader);
  }
  EXPECT_TRUE(walker.step(eye, 0.1).missing);
  EXPECT_EQ(walker.step(eye, 0.1).shown, tree.node(bad).parent) << "the deepest one that is there";
  // Elsewhere nothing is wrong.
  const glm::dvec3 elsewhere = options_.regions[1].min;
  walker.step(elsewhere, 0.1);
  load_all(loader);
  EXPECT_FALSE(walker.step(elsewhere, 0.1).late);
}

// Bytes that change while the file is open are found by their checksum; a file that is removed or replaced stays as it
// was opened.
TEST_F(CellWalkerTest, NoticesWhatHappensToTheFile) {
  CellWalker removed(file_, objects_, by_hand());
  const std::filesystem::path other = folder_ / "other.vlod";
  std::filesystem::copy_file(path_, other);
  const auto damaged_file = open_vlod(other, objects_);
  CellWalker damaged(damaged_file, objects_, by_hand());
  CellLoader removed_loader(removed), damaged_loader(damaged);
  std::filesystem::rename(other, folder_ / "third.vlod");
  const std::string bytes = test::bytes_of_file(path_);
  std::fstream(folder_ / "third.vlod", std::ios::in | std::ios::out | std::ios::binary)
      << std::string(bytes.size(), 'x');
  std::filesystem::remove(path_);
  std::ofstream(path_) << "something else";
  for (const glm::dvec3& eye : walk_in(options_.regions[0], 0.05)) {
    removed.step(eye, 0.1);
    damaged.step(eye, 0.1);
    load_all(removed_loader);
    load_all(damaged_loader);
    EXPECT_FALSE(removed.step(eye, 0.0).late);
    const WalkedFrame& frame = damaged.step(eye, 0.0);
    expect_sound(frame, WalkOptions().memory);
    EXPECT_EQ(frame.shown, 0U) << "which was read before";
  }
  ASSERT_FALSE(notes_.empty());
  EXPECT_NE(notes_[0].find("checksum"), std::string::npos) << notes_[0];
}

// A disk that answers nothing until it is told to: frames go on.
TEST_F(CellWalkerTest, NeverWaitsForTheDisk) {
  std::mutex mutex;
  std::condition_variable changed;
  bool open = false, asked = false;
  const WalkOptions options{.loaders = 2};
  CellWalker walker(file_, objects_, options);
  walker.set_trial({.reader = [&](CellId cell, std::span<const CellAdditions* const> above) {
    {
      std::unique_lock lock(mutex);
      asked = true;
      changed.notify_all();
      changed.wait(lock, [&] { return open; });
    }
    return file_->read(cell, above);
  }});
  const std::vector<glm::dvec3> eyes = walk_in(options_.regions[0], 0.02);
  walker.step(eyes[0], 0.1);
  {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return asked; });
  }
  for (const glm::dvec3& eye : eyes) {
    const WalkedFrame& frame = walker.step(eye, 1.0 / 60.0);
    expect_sound(frame, options.memory);
    EXPECT_TRUE(frame.late);
  }
  {
    const std::lock_guard lock(mutex);
    open = true;
  }
  changed.notify_all();
  // From now on it comes, sooner or later.
  while (walker.step(eyes.back(), 1.0 / 60.0).late) std::this_thread::yield();
  expect_cut_of(walker.step(eyes.back(), 0.0), file_->tree().leaf_of(eyes.back()));
}

// Nothing is left out that the view shows, and not everything is drawn.
TEST_F(CellWalkerTest, DrawsWhatIsInTheFrustum) {
  CellWalker walker(file_, objects_, by_hand());
  CellLoader loader(walker);
  std::size_t all = 0, some = 0;
  for (const glm::dvec3& eye : walk_in(options_.regions[0], 0.2)) {
    walker.step(eye, 0.1);
    load_all(loader);
    const WalkedFrame& frame = walker.step(eye, 0.1);
    for (const glm::dvec3 direction : {glm::dvec3(-1, 0.1, 0), glm::dvec3(0.2, 1, 0.1), glm::dvec3(0.3, -1, 0.2)}) {
      Camera camera{eye, eye + direction, {0, 0, 1}};
      camera.fov_y_deg = 35.0;
      camera.width = camera.height = 64;
      camera.near = 0.01;
      camera.far = 100.0;
      const View view(camera);
      std::vector<ObjectRange> ranges;
      ranges_in_view(frame, objects_, view, ranges);
      std::vector<DrawObject> whole, parts;
      for (std::size_t i = 0; i < 3; ++i) {
        whole.push_back(
            {objects_[i].hierarchy->positions(), {}, frame.objects[i].triangles, objects_[i].object_to_world});
        all += frame.objects[i].triangles.size();
      }
      for (const ObjectRange& range : ranges) {
        parts.push_back(whole[range.object]);
        parts.back().triangles = parts.back().triangles.subspan(range.first, range.count);
        some += range.count;
      }
      ItemBuffer expected, found;
      draw_items(expected, whole, view);
      draw_items(found, parts, view);
      EXPECT_EQ(found.depth.nearness, expected.depth.nearness);
    }
  }
  EXPECT_LT(some, all);
}

TEST_F(CellWalkerTest, WaitsAsLongAsADiskWould) {
  double waited = 0.0;
  const CellReader reader = tool::throttled(
      [&](CellId cell, std::span<const CellAdditions* const> above) { return file_->read(cell, above); }, *file_,
      {1e6, 0.25}, [&](double seconds) { waited += seconds; });
  static_cast<void>(reader(0, {}));
  EXPECT_DOUBLE_EQ(waited, 0.25 + 1e-6 * file_->tree().node(0).payload_bytes);
  EXPECT_THROW(tool::throttled(reader, *file_, {0.0, 0.0}, [](double) {}), Error);
  EXPECT_THROW(tool::throttled(reader, *file_, {1.0, -1.0}, [](double) {}), Error);
}

TEST_F(CellWalkerTest, RefusesWrongOptions) {
  WalkOptions options;
  options.loaders = -1;
  EXPECT_THROW(CellWalker(file_, objects_, options), Error);
  EXPECT_THROW(CellWalker(file_, std::span(objects_).first(2), {}), Error);
}

}  // namespace
}  // namespace occlod
