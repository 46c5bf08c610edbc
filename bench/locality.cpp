// bench_locality: what the order of the splits is worth. The same hierarchy as it is built, and with its splits (hence
// its vertices and stars) shuffled within each level of dependency: still from coarse to fine, but neighbours in space
// are no longer neighbours in memory.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <string>
#include <vector>

#include "base/timing.h"
#include "occlod/build_hierarchy.h"
#include "occlod/refiner.h"
#include "refine/tuning.h"
#include "stopwatch.h"
#include "support/bench_meshes.h"
#include "support/planet_views.h"
#include "support/renumber.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

struct Options {
  std::string mesh = "planet:10";
  std::vector<std::size_t> budgets = {10'000, 100'000, 1'000'000};
  int repeat = 9;
};

double refine_ms(Refiner& refiner, const Camera& camera, const RefineOptions& options) {
  NoOcclusion none;
  const tool::Stopwatch stopwatch;
  static_cast<void>(refiner.refine(View(camera), options, none));
  return stopwatch.milliseconds();
}

void run(const Options& options) {
  const Hierarchy built = build_hierarchy(load_bench_mesh(options.mesh));
  const Hierarchy shuffled = renumbered(built, shuffled_levels(built, 1));
  std::array<Refiner, 2> refiners = {Refiner(std::vector<RefineObject>{{&built, glm::dmat4(1.0), false}}),
                                     Refiner(std::vector<RefineObject>{{&shuffled, glm::dmat4(1.0), false}})};
  fmt::print(
      "| mesh | view | culling | budget | as built, ms | shuffled, ms | ratio |\n|---|---|---|---|---|---|---|\n");
  for (const NamedCamera& view : planet_views())
    for (const Culling culling : {Culling::subtree, Culling::star})
      for (const std::size_t budget : options.budgets) {
        RefineOptions refine_options;
        tune(refine_options).culling = culling;
        refine_options.budget = budget;
        std::array<std::vector<double>, 2> ms;
        for (int round = 0; round <= options.repeat; ++round)
          for (std::size_t i = 0; i < refiners.size(); ++i) {
            const double once = refine_ms(refiners[i], view.camera, refine_options);
            if (round > 0) ms[i].push_back(once);
          }
        const double as_built = median(ms[0]), as_shuffled = median(ms[1]);
        fmt::print("| {} | {} | {} | {} | {:.2f} | {:.2f} | {:.2f} |\n", options.mesh, view.name, name_of(culling),
                   budget, as_built, as_shuffled, as_shuffled / as_built);
      }
}

int run(int argc, char** argv) {
  CLI::App app("What the order of the splits is worth.", "bench_locality");
  Options options;
  app.add_option("MESH", options.mesh, "planet:LEVEL")->capture_default_str();
  app.add_option("--budgets", options.budgets, "Triangles")->capture_default_str();
  add_repeat_option(app, options.repeat, "Rounds after the first");
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
