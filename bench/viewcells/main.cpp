// bench_viewcells FILE.vlod SCENE.json: what walking through view cells is asked to reach, measured, as one JSON object
// for scripts/viewcells_table.py. Times are of this thread's processor, but for drawing.
#include <fmt/format.h>
#include <xxhash.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/arithmetic.h"
#include "base/timing.h"
#include "cell_sight.h"
#include "cell_walk.h"
#include "drawing.h"
#include "json_output.h"
#include "occlod/base.h"
#include "occlod/cell_builder.h"
#include "occlod/visibility.h"
#include "stopwatch.h"
#include "support/cpu_clock.h"

namespace occlod::bench {
namespace {

using tool::CellWalk;
using tool::CellWalkFrame;
using tool::Json;

constexpr tool::DiskSpeed disk{100e6, 5e-3};
constexpr std::size_t most_refined = 1'000'000;  // triangles by refinement, where the tolerance needs more

struct Options {
  std::filesystem::path file, scene;
  std::size_t cells = 16;  // of which cuts are measured
  int frames = 12;         // of each path that are compared with refinement and with the full mesh
  int random_eyes = 116;   // 125 with the corners and the middle
  int image_size = 1024;
};

struct Subject {
  SceneDescription description;
  std::vector<LoadedObject> loaded;
  std::vector<RefineObject> objects;
  std::shared_ptr<const VlodFile> file;
};

Subject load(const Options& options) {
  Subject subject;
  subject.description = read_scene(options.scene);
  subject.loaded = load_objects(subject.description, options.scene.parent_path());
  subject.objects = tool::refine_objects(subject.loaded);
  subject.file = open_vlod(options.file, subject.objects);
  return subject;
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

Json spread(const std::vector<double>& values) {
  return {{"median", median(values)},
          {"p99", percentile(values, 0.99)},
          {"largest", percentile(values, 1.0)},
          {"count", values.size()}};
}

template <typename Value>
void hash_more(std::uint64_t& hash, const std::vector<Value>& values) {
  hash = XXH3_64bits_withSeed(values.data(), values.size() * sizeof(Value), hash);
}

// Cuts of some cells: what they draw, with what it takes, and what of it 125 eyes see.
Json measure_cells(const Options& options, const Subject& subject) {
  const CellTree& tree = subject.file->tree();
  const CellTreeOptions& built = subject.file->options();
  std::vector<CellId> leaves;
  for (CellId n = 0; n < tree.nodes().size(); ++n)
    if (tree.is_leaf(n)) leaves.push_back(n);
  const double start = thread_cpu_ms();
  const CellOccluders occluders(subject.objects, built.occluder_motion.value_or(0.25 * built.smallest_cell));
  const double occluders_ms = thread_cpu_ms() - start;
  CellBuilder builder(subject.objects, &occluders, built.cell), without(subject.objects, nullptr, built.cell);
  std::vector<double> seconds, over_seen, over_none;
  std::uint64_t hash = 0;
  std::size_t differ = 0;
  const std::size_t count = std::min(options.cells, leaves.size());
  for (std::size_t i = 0; i < count; ++i) {
    const CellId cell = leaves[i * leaves.size() / count];
    const CellBox& box = tree.node(cell).box;
    const double begun = thread_cpu_ms();
    const CellCut& cut = builder.build(box);
    seconds.push_back(1e-3 * (thread_cpu_ms() - begun));
    const std::size_t none = without.build(box).drawn_triangles;
    for (const CellObjectCut& object : cut.objects) hash_more(hash, object.applied);
    differ += cut.drawn_triangles == tree.node(cell).drawn_triangles ? 0U : 1U;
    const std::size_t seen = tool::count_seen(box, subject.objects, built.cell.eyes.near, cut.objects,
                                              {options.random_eyes, options.image_size, 1});
    over_seen.push_back(static_cast<double>(cut.drawn_triangles) / static_cast<double>(std::max<std::size_t>(seen, 1)));
    over_none.push_back(static_cast<double>(cut.drawn_triangles) / static_cast<double>(std::max<std::size_t>(none, 1)));
  }
  return {{"seconds", spread(seconds)},
          {"drawn_over_seen", spread(over_seen)},
          {"drawn_over_no_occlusion", spread(over_none)},
          {"occluders_s", 1e-3 * occluders_ms},
          {"occluder_triangles", occluders.triangle_count()},
          {"differ_from_file", differ},
          {"hash", fmt::format("{:016x}", hash)}};
}

// A refiner that follows the walk, frame to frame, to the tolerance of the cells.
class Refining {
 public:
  explicit Refining(const Subject& subject) : refiner_(subject.objects), visibility_(make_software_occlusion()) {
    options_.budget = most_refined;
    options_.tolerance_px = subject.file->options().cell.tolerance_px;
  }
  const Refinement& update(const View& view) { return refiner_.update(view, options_, *visibility_); }

 private:
  Refiner refiner_;
  std::unique_ptr<Visibility> visibility_;
  RefineOptions options_;
};

struct WalkValues {
  std::vector<double> frame_ms, picture_ms;  // without and with drawing
  std::vector<double> over_full, over_update, update_ms, ms_over_update, depth_rms_px, full_triangles;
  std::size_t unexplained = 0, update_unexplained = 0, update_at_budget = 0;
};

// Compares the frame that was drawn last.
void compare(const View& view, const CellWalkFrame& frame, const CellWalk& walk, const Subject& subject,
             tool::WalkReference& reference, Refining& refining, WalkValues& values) {
  const double start = thread_cpu_ms();
  const Refinement& refined = refining.update(view);
  const double update_ms = thread_cpu_ms() - start;
  const auto full = static_cast<double>(reference.full().triangles_in_view(view));
  reference.set_view(view);
  const double tolerance = subject.file->options().cell.tolerance_px;
  const auto distance = reference.compare(view, walk.items().depth, tolerance);
  values.unexplained += distance.unexplained_px;
  values.depth_rms_px.push_back(distance.depth_rms_px);
  ItemBuffer items;
  draw_items(items, tool::draw_objects(subject.loaded, refined), view);
  values.update_unexplained += reference.compare(view, items.depth, tolerance).unexplained_px;
  values.update_at_budget += refined.stats.triangles + 100 > most_refined ? 1U : 0U;
  values.full_triangles.push_back(full);
  values.over_full.push_back(static_cast<double>(frame.view_triangles) / std::max(full, 1.0));
  values.over_update.push_back(static_cast<double>(frame.view_triangles) /
                               static_cast<double>(std::max<std::size_t>(refined.stats.triangles, 1)));
  values.update_ms.push_back(update_ms);
  values.ms_over_update.push_back((frame.step_ms + frame.cull_ms) / std::max(update_ms, 1e-6));
}

// Stands until cells are loaded, then walks.
Json walk_path(const Options& options, const Subject& subject, const CameraPath& path, tool::WalkReference& reference) {
  Refining refining(subject);
  CellWalk walk(subject.file, subject.objects, {.disk = disk});
  walk.stand(camera_at(path, 0), 2.0);
  WalkValues values;
  std::vector<CellId> shown;
  std::size_t late = 0, outside = 0, crossings = 0, bytes = 0, resident = 0, triangles = 0;
  const int every = std::max(1, path.frames / options.frames);
  for (int i = 0; i < path.frames; ++i) {
    const CellWalkFrame& frame = walk.go_to(camera_at(path, i));
    values.frame_ms.push_back(frame.step_ms + frame.cull_ms);
    values.picture_ms.push_back(frame.step_ms + frame.cull_ms + frame.draw_ms);
    shown.push_back(frame.walked.shown);
    late += frame.walked.late ? 1U : 0U;
    outside += frame.walked.outside ? 1U : 0U;
    crossings += frame.walked.crossed ? 1U : 0U;
    bytes += frame.walked.bytes_read;
    triangles += frame.view_triangles;
    resident = std::max(resident, frame.walked.resident_bytes);
    const View view(frame.camera);
    if (i % every == every - 1)
      compare(view, frame, walk, subject, reference, refining, values);
    else if (i % every == every - 2)
      static_cast<void>(refining.update(view));
  }
  std::uint64_t hash = triangles;
  hash_more(hash, shown);
  Json result = {{"frames", path.frames},
                 {"crossings", crossings},
                 {"late", late},
                 {"outside", outside},
                 {"bytes_read", bytes},
                 {"resident_bytes", resident},
                 {"frame_ms", spread(values.frame_ms)},
                 {"picture_ms", spread(values.picture_ms)}};
  if (!values.update_ms.empty())
    result["compared"] = {{"full_triangles", spread(values.full_triangles)},
                          {"over_full", spread(values.over_full)},
                          {"over_update", spread(values.over_update)},
                          {"update_ms", spread(values.update_ms)},
                          {"ms_over_update", spread(values.ms_over_update)},
                          {"depth_rms_px", spread(values.depth_rms_px)},
                          {"unexplained_px", values.unexplained},
                          {"update_unexplained_px", values.update_unexplained},
                          {"update_at_budget", values.update_at_budget}};
  result["hash"] = fmt::format("{:016x}", hash);
  return result;
}

std::size_t late_without_prefetch(const Subject& subject, const CameraPath& path) {
  CellWalk walk(subject.file, subject.objects, {.prefetch = false, .disk = disk});
  walk.stand(camera_at(path, 0), 2.0);
  std::size_t late = 0;
  for (int i = 0; i < path.frames; ++i) late += walk.step_to(camera_at(path, i)).late ? 1U : 0U;
  return late;
}

// From key to key of a path that jumps: how long until the cell is there, and whether something is meanwhile.
Json teleport(const Subject& subject, const CameraPath& path) {
  CellWalk walk(subject.file, subject.objects, {.disk = disk});
  walk.stand(path.keys.front(), 2.0);
  std::vector<double> complete_ms;
  std::size_t empty = 0;
  for (std::size_t i = 1; i < path.keys.size(); ++i) {
    int frames = 0;
    for (; frames < 600; ++frames) {
      const WalkedFrame& frame = walk.step_to(path.keys[i]);
      empty += frame.drawn_triangles == 0 ? 1U : 0U;
      if (!frame.late) break;
    }
    complete_ms.push_back(1e3 * tool::walk_frame_seconds * frames);
  }
  return {{"complete_ms", spread(complete_ms)}, {"empty_frames", empty}};
}

std::size_t hierarchy_bytes(const Subject& subject) {
  std::set<const Hierarchy*> different;
  std::size_t bytes = 0;
  for (const RefineObject& object : subject.objects)
    if (different.insert(object.hierarchy).second) bytes += object.hierarchy->bytes();
  return bytes;
}

void run(const Options& options) {
  const Subject subject = load(options);
  tool::WalkReference reference(subject.objects);
  Json result = {
      {"scene", subject.description.name},          {"triangles", reference.full().triangle_count()},
      {"cells", subject.file->tree().leaf_count()}, {"tolerance_px", subject.file->options().cell.tolerance_px},
      {"vlod_bytes", subject.file->file_bytes()},   {"hierarchy_bytes", hierarchy_bytes(subject)}};
  for (const auto& [name, path] : subject.description.paths) {
    if (path.jump) {
      result["teleports"] = teleport(subject, path);
    } else {
      result["paths"][name] = walk_path(options, subject, path, reference);
      result["paths"][name]["late_without_prefetch"] = late_without_prefetch(subject, path);
    }
    fmt::print(stderr, "bench_viewcells: {} done\n", name);
  }
  result["cuts"] = measure_cells(options, subject);
  tool::print_json(result);
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) {
  CLI::App app("What walking through view cells is asked to reach, measured");
  occlod::bench::Options options;
  bool quick = false;
  app.add_option("FILE", options.file, "Cells, .vlod")->required();
  app.add_option("SCENE", options.scene, "Scene that they were built of, .json")->required();
  app.add_option("--cells", options.cells, "Cells of which cuts are measured")->check(CLI::PositiveNumber);
  app.add_option("--frames", options.frames, "Frames of each path to compare")->check(CLI::PositiveNumber);
  app.add_flag("--quick", quick, "Smaller images and fewer of everything: figures are rough");
  CLI11_PARSE(app, argc, argv);
  if (quick) options = {options.file, options.scene, 4, 3, 20, 256};
  try {
    occlod::bench::run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_viewcells: {}\n", error.what());
    return 1;
  }
}
