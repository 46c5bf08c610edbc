#include "occlod/viewcells/build_cells.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>
#include <vector>

#include "core/option_checker.h"
#include "hierarchy/parallel.h"
#include "occlod/core/error.h"
#include "viewcells/cell_divider.h"
#include "viewcells/cell_forest.h"
#include "viewcells/write_vlod.h"

namespace occlod {
namespace {

// One for all threads.
class BuildRun {
 public:
  BuildRun(const CellBuildRun& run, std::size_t roots) : run_(run), roots_(static_cast<double>(roots)) {}

  // A share of a root cell is done. Throws Error when the build is cancelled.
  void advance(double share) {
    const double done = done_.fetch_add(share / roots_) + share / roots_;
    if (!run_.progress || std::this_thread::get_id() != caller_) return;
    if (!run_.progress(std::min(done, 1.0))) throw Error({"cells", "", "the build was cancelled", ""});
  }

 private:
  const CellBuildRun& run_;
  double roots_;
  std::thread::id caller_ = std::this_thread::get_id();
  std::atomic<double> done_ = 0.0;
};

void check_run(std::span<const RefineObject> objects, const CellTreeOptions& options, const CellBuildRun& run) {
  vlod::check(options, "cell options");
  OptionChecker("cell options").in_range("threads", run.threads, 0, 1024);
  for (const RefineObject& object : objects)
    if (object.hierarchy == nullptr)
      throw Error({"cells", "", "an object has no hierarchy", "build one with build_hierarchy()"});
}

}  // namespace

CellBuildStats build_cells(std::span<const RefineObject> objects, const CellTreeOptions& options,
                           const std::filesystem::path& path, const CellBuildRun& run) {
  check_run(objects, options, run);
  const vlod::Scene scene{options, vlod::describe(objects)};
  const vlod::GlobalIds ids(scene.objects, "cells");
  const std::vector<RootCell> roots = root_cells(options);
  const CellOccluders occluders(objects, options.occluder_motion.value_or(options.smallest_cell / 4.0));
  std::vector<CellSubtree> trees(roots.size());
  std::atomic<std::size_t> cuts = 0;
  BuildRun shared(run, roots.size());
  for_each_task(
      roots.size(), thread_count(run.threads), [&] { return CellDivider(objects, &occluders, options, ids); },
      [&](CellDivider& divider, std::size_t i) {
        const std::size_t before = divider.cuts();
        trees[i] = divider.divide(roots[i].box, [&](double share) { shared.advance(share); });
        cuts += divider.cuts() - before;
      },
      [] {});
  CellSubtree tree = join_roots(roots, [&](std::size_t i) { return std::exchange(trees[i], {}); });
  finish(tree);
  write_vlod(path, scene, tree);
  return {cuts};
}

}  // namespace occlod
