// bench_error_bound: what a hierarchy promises (SplitNode::guaranteed_error) beside the distance that is measured.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include "base/timing.h"
#include "measure/surface_distance.h"
#include "occlod/build_hierarchy.h"
#include "support/bench_meshes.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

struct Options {
  std::vector<std::string> meshes = {"planet:7",
                                     "planet:8",
                                     "scans/armadillo_100k.obj",
                                     "scans/bun_zipper.ply",
                                     "scans/dragon_vrip_res2.ply",
                                     "scans/dragon_vrip_res3.ply",
                                     "scans/fandisk.obj",
                                     "scans/gargo.ply",
                                     "scans/horse.ply",
                                     "scans/nefertiti.obj",
                                     "scans/turbineblade.ply"};
  std::vector<double> tolerances = {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0};  // percent of the diagonal
  std::size_t samples = 200'000;
  int repeat = 3;
};

struct Bound {
  std::string name;
  BuildOptions options;
};

// And its time in milliseconds: processor time of one thread, which other programs disturb little.
std::pair<Hierarchy, double> build_timed(const TriangleMesh& mesh, BuildOptions options, int repeat) {
  options.threads = 1;
  std::vector<double> milliseconds;
  Hierarchy hierarchy;
  for (int i = 0; i < repeat; ++i) {
    const std::clock_t start = std::clock();
    hierarchy = build_hierarchy(mesh, options);
    milliseconds.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return {std::move(hierarchy), median(std::move(milliseconds))};
}

// One row a tolerance that has a cut of its own: neither the input nor the cut of the tolerance before.
void print_rows(const std::string& name, const TriangleMesh& mesh, const Bound& bound, const Options& options) {
  const auto [hierarchy, milliseconds] = build_timed(mesh, bound.options, options.repeat);
  const measure::Surface input(mesh.positions, mesh.triangles);
  std::vector<double> ratios;
  std::size_t broken = 0;
  std::size_t last = mesh.triangle_count();
  for (const double tolerance : options.tolerances) {
    const FixedCut cut = cut_to_error(hierarchy, tolerance / 100.0 * input.diagonal());
    if (std::exchange(last, cut.triangles) == cut.triangles || !(cut.guaranteed_error > 0.0F)) continue;
    const TriangleMesh coarse = cut_mesh(hierarchy, cut);
    const measure::Surface surface(coarse.positions, coarse.triangles);
    const double measured = measure::surface_distance(input, surface, {options.samples, 1}).farther().max;
    const double promised = cut.guaranteed_error;
    broken += measured > promised ? 1 : 0;
    ratios.push_back(promised / measured);
    fmt::print("| {} | {} | {} | {} | {:.4f} | {:.4f} | {:.2f} |\n", name, bound.name, tolerance, cut.triangles,
               100.0 * promised / input.diagonal(), 100.0 * measured / input.diagonal(), ratios.back());
  }
  if (ratios.empty()) return;
  fmt::print("| **{}** | {} | {:.0f} ms | {} broken | | median | **{:.2f}** |\n", name, bound.name, milliseconds,
             broken, median(ratios));
  std::fflush(stdout);
}

void run(const Options& options) {
  std::vector<Bound> bounds = {{"accumulated", {}}, {"measured", {}}};
  bounds[1].options.error_bound = ErrorBound::measured;
  fmt::print(
      "| mesh | bound | tolerance % | triangles | promised % | measured % | ratio |\n|---|---|---|---|---|---|---|\n");
  for (const std::string& name : available(options.meshes)) {
    const TriangleMesh mesh = load_bench_mesh(name);
    for (const Bound& bound : bounds) print_rows(name, mesh, bound, options);
  }
}

int run(int argc, char** argv) {
  CLI::App app("What hierarchies promise beside the distance that is measured.", "bench_error_bound");
  Options options;
  app.add_option("MESHES", options.meshes, "Files in folders of OCCLOD_MESHES, or planet:LEVEL")->capture_default_str();
  app.add_option("--tolerances", options.tolerances, "Percent of the diagonal, ascending")->capture_default_str();
  app.add_option("--samples", options.samples, "Points on each surface")->capture_default_str();
  add_repeat_option(app, options.repeat, "Builds");
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
