#include "occlod/hlod/build.h"

#include <cmath>
#include <utility>
#include <vector>

#include "assemble.h"
#include "core/large_vector.h"
#include "core/option_checker.h"
#include "finish_level.h"
#include "group_triangles.h"
#include "hierarchy/build_progress.h"
#include "hierarchy/check_input.h"
#include "hierarchy/parallel.h"
#include "occlod/core/error.h"
#include "simplify_nodes.h"
#include "wedge_mesh.h"
#include "weld_pieces.h"

namespace occlod::hlod {
namespace {

constexpr double least_progress = 0.97;  // a level with a larger share of the triangles below it is left out
constexpr double grouped = 0.15, simplified = 0.85;  // shares of the whole time

void check_options(const BuildOptions& options) {
  const OptionChecker check("hlod build");
  check.in_range("node_triangles", options.node_triangles, 16, 4096);
  check.in_range("boundary_weight", options.boundary_weight, 0.0, 1e6);
  check.in_range("attribute_weight", options.attribute_weight, 0.0, 1e6);
  check.in_range("threads", options.threads, 0, 1024);
  if (options.grouping == Grouping::shifted && options.borders == Borders::free)
    throw Error({"hlod build", "option borders", "shifted groups need locked borders",
                 "choose nested groups or locked borders"});
}

class Builder {
 public:
  Builder(WedgeMesh mesh, const BuildOptions& options)
      : mesh_(std::move(mesh)),
        within_(options.within),
        threads_(thread_count(options.threads)),
        progress_(options.progress),
        grouping_(mesh_, options, threads_),
        simplifier_(mesh_, options, threads_) {}

  HlodData run() {
    progress_.reach(0.0);
    levels_.push_back(input_level(mesh_, grouping_.group_input(), threads_));
    while (levels_.back().nodes.size() > 1 && add_level()) continue;
    return assemble(mesh_, std::move(levels_), within_, threads_);
  }

 private:
  // Whether there may be another.
  bool add_level() {
    LevelDraft& below = levels_.back();
    const double before = share_of(levels_.size() - 1), after = share_of(levels_.size());
    TriangleGroups groups = grouping_.group_level(below, static_cast<unsigned>(levels_.size()));
    const ProgressPart part{progress_, before + grouped * (after - before), after,
                            static_cast<double>(below.triangles.size())};
    part.reach(0);
    LevelDraft level = simplifier_.run(below, std::move(groups), part);
    if (!level.triangles.empty() &&
        static_cast<double>(level.triangles.size()) > least_progress * static_cast<double>(below.triangles.size())) {
      below.parent_of = {};
      return false;
    }
    levels_.push_back(std::move(level));
    return !levels_.back().triangles.empty();
  }

  // What is done when so many levels above the input are: each takes a quarter of the time of the one below.
  static double share_of(std::size_t levels) {
    return simplified * (1.0 - std::pow(0.25, static_cast<double>(levels)));
  }

  WedgeMesh mesh_;
  Within within_;
  unsigned threads_;
  BuildProgress progress_;
  TriangleGrouping grouping_;
  NodeSimplifier simplifier_;
  std::vector<LevelDraft> levels_;
};

Hlod build(WedgeMesh mesh, const BuildOptions& options) {
  const LargeMemoryReuse reuse;
  HlodData data = Builder(std::move(mesh), options).run();
  data.grouping = options.grouping;
  data.borders = options.borders;
  data.node_triangles = options.node_triangles;
  return make_hlod(std::move(data));
}

}  // namespace

Hlod build_hlod(const TriangleMesh& mesh, const BuildOptions& options) {
  check_options(options);
  check_input(mesh);
  check_welded(mesh);
  return build(to_wedge_mesh(mesh, thread_count(options.threads)), options);
}

Hlod build_hlod(const TriangleSource& source, const BuildOptions& options, MeshReport& report) {
  check_options(options);
  PieceCollector pieces;
  source(pieces);
  if (pieces.report().triangles_read == pieces.report().repeated_index_triangles)
    throw Error({"hlod build", "", "the source has no triangle with three different corners", "give one at least"});
  WedgeMesh mesh = pieces.weld(thread_count(options.threads));
  report = pieces.report();
  return build(std::move(mesh), options);
}

}  // namespace occlod::hlod
