#include "occlod/hlod/build.h"

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "hlod/build/assemble.h"
#include "hlod/build/build_journal.h"
#include "base/large_vector.h"
#include "base/option_checker.h"
#include "hlod/build/finish_level.h"
#include "hlod/build/group_triangles.h"
#include "splits/build_progress.h"
#include "splits/check_input.h"
#include "splits/parallel.h"
#include "occlod/core/error.h"
#include "occlod/mesh/clean.h"
#include "occlod/mesh/quantise.h"
#include "hlod/build/simplify_nodes.h"
#include "hlod/store/wedge_mesh.h"
#include "hlod/build/weld_pieces.h"

namespace occlod::hlod {
namespace {

constexpr double least_progress = 0.97;  // a level with a larger share of the triangles below it is left out
constexpr double grouped = 0.15, simplified = 0.85;  // shares of the whole time

void check_options(const BuildOptions& options) {
  const OptionChecker check("hlod build");
  check.in_range("node_triangles", options.node_triangles, 16, 4096);
  check.in_range("boundary_weight", options.boundary_weight, 0.0, 1e6);
  check.in_range("attribute_weight", options.attribute_weight, 0.0, 1e6);
  if (options.quantise_bits != 0) check.in_range("quantise_bits", options.quantise_bits, 8, 23);
  check.in_range("threads", options.threads, 0, 1024);
  if (options.grouping == Grouping::shifted && options.borders == Borders::free)
    throw Error({"hlod build", "option borders", "shifted groups need locked borders",
                 "choose nested groups or locked borders"});
}

class Builder {
 public:
  // `journal`, which may be null, and the options outlive it.
  Builder(WedgeMesh mesh, const BuildOptions& options, BuildJournal* journal)
      : mesh_(std::move(mesh)),
        within_(options.within),
        threads_(thread_count(options.threads)),
        progress_(options.progress),
        journal_(journal),
        grouping_(mesh_, options, threads_),
        simplifier_(mesh_, options, threads_, journal) {}

  HlodData run() {
    progress_.reach(0.0);
    const TriangleGroups groups = known_or(mesh_.triangles.size(), [&] { return grouping_.group_input(); });
    levels_.push_back(input_level(mesh_, groups, threads_));
    while (levels_.back().nodes.size() > 1 && add_level()) continue;
    return assemble(mesh_, std::move(levels_), within_, threads_);
  }

 private:
  // Whether there may be another.
  bool add_level() {
    LevelDraft& below = levels_.back();
    const double before = share_of(levels_.size() - 1), after = share_of(levels_.size());
    TriangleGroups groups = known_or(
        below.triangles.size(), [&] { return grouping_.group_level(below, static_cast<unsigned>(levels_.size())); });
    grouping_.finish_level(below, groups);
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

  // The next groups in the journal, of so many triangles, or those that make() makes.
  template <typename Make>
  TriangleGroups known_or(std::size_t triangles, const Make& make) {
    TriangleGroups groups;
    if (journal_ != nullptr && journal_->take(triangles, groups)) return groups;
    groups = make();
    if (journal_ != nullptr) journal_->append(groups);
    return groups;
  }

  // What is done when so many levels above the input are: each takes a quarter of the time of the one below.
  static double share_of(std::size_t levels) {
    return simplified * (1.0 - std::pow(0.25, static_cast<double>(levels)));
  }

  WedgeMesh mesh_;
  Within within_;
  unsigned threads_;
  BuildProgress progress_;
  BuildJournal* journal_;
  TriangleGrouping grouping_;
  NodeSimplifier simplifier_;
  std::vector<LevelDraft> levels_;
};

Hlod build(WedgeMesh mesh, float lattice_step, const BuildOptions& options, BuildJournal* journal) {
  const LargeMemoryReuse reuse;
  if (journal != nullptr) journal->begin(mesh);
  HlodData data = Builder(std::move(mesh), options, journal).run();
  if (journal != nullptr && options.resumed) options.resumed(journal->taken());
  data.grouping = options.grouping;
  data.borders = options.borders;
  data.node_triangles = options.node_triangles;
  data.lattice_step = lattice_step;
  return make_hlod(std::move(data));
}

// Before the mesh is there, so that a journal that does not fit is told at once. Null: none.
std::unique_ptr<BuildJournal> open_journal(const BuildOptions& options) {
  return options.journal.empty() ? nullptr : std::make_unique<BuildJournal>(options.journal, options);
}

// Of the lattice of positions; 0 without one.
float step_of(std::span<const glm::vec3> positions, const BuildOptions& options) {
  return options.quantise_bits == 0 ? 0.0F : lattice_step(bounding_box(positions), options.quantise_bits);
}

}  // namespace

Hlod build_hlod(const TriangleMesh& mesh, const BuildOptions& options) {
  check_options(options);
  const std::unique_ptr<BuildJournal> journal = open_journal(options);
  check_input(mesh);
  check_welded(mesh);
  const unsigned threads = thread_count(options.threads);
  const float step = step_of(mesh.positions, options);
  if (step == 0.0F) return build(to_wedge_mesh(mesh, threads), step, options, journal.get());
  TriangleMesh rounded = mesh;
  round_to_lattice(rounded, step);
  return build(to_wedge_mesh(clean(std::move(rounded), {}, "rounded mesh").mesh, threads), step, options,
               journal.get());
}

Hlod build_hlod(const TriangleSource& source, const BuildOptions& options, MeshReport& report) {
  check_options(options);
  const std::unique_ptr<BuildJournal> journal = open_journal(options);
  PieceCollector pieces;
  source(pieces);
  if (pieces.report().triangles_read == pieces.report().repeated_index_triangles)
    throw Error({"hlod build", "", "the source has no triangle with three different corners", "give one at least"});
  const float step = step_of(pieces.positions(), options);
  if (step > 0.0F) pieces.round(step);
  WedgeMesh mesh = pieces.weld(thread_count(options.threads));
  report = pieces.report();
  return build(std::move(mesh), step, options, journal.get());
}

}  // namespace occlod::hlod
