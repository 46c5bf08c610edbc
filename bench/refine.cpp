// bench_refine: what refinement costs on the same planet at several levels, from files as users have them.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/timing.h"
#include "occlod/build_hierarchy.h"
#include "occlod/refiner.h"
#include "refine/tuning.h"
#include "stopwatch.h"
#include "support/bench_meshes.h"
#include "support/memory.h"
#include "support/planet_views.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<int> levels = {8, 11};
  std::vector<std::size_t> budgets = {10'000, 1'000'000};
  fs::path folder;
  int repeat = 15;
};

struct Planet {
  int level = 0;
  double file_mb = 0.0;
  double open_ms = 0.0;
  std::shared_ptr<const Hierarchy> hierarchy;
  std::unique_ptr<Refiner> refiner;
};

// The planet's file, built when the folder does not have it.
fs::path file_of(int level, const fs::path& folder) {
  const fs::path file = folder / fmt::format("planet{}.v{}.olod", level, olod_version);
  if (fs::exists(file)) return file;
  fmt::print(stderr, "building planet {}\n", level);
  fs::create_directories(folder);
  write_olod(file, build_hierarchy(load_bench_mesh(fmt::format("planet:{}", level))), {});
  return file;
}

Planet open(int level, const fs::path& folder) {
  const fs::path file = file_of(level, folder);
  Planet planet;
  planet.level = level;
  planet.file_mb = static_cast<double>(fs::file_size(file)) / 1e6;
  const tool::Stopwatch stopwatch;
  planet.hierarchy = std::make_shared<const Hierarchy>(read_olod(file).hierarchy);
  planet.refiner =
      std::make_unique<Refiner>(std::vector<RefineObject>{{planet.hierarchy.get(), glm::dmat4(1.0), false}});
  planet.open_ms = stopwatch.milliseconds();
  return planet;
}

struct Run {
  double first_ms = 0.0;
  std::vector<double> ms;
  RefineStats stats;
  std::uint64_t hash = 0;
};

void refine(const Planet& planet, const Camera& camera, const RefineOptions& options, Run& run) {
  NoOcclusion none;
  const tool::Stopwatch stopwatch;
  const Refinement& refinement = planet.refiner->refine(View(camera), options, none);
  const double ms = stopwatch.milliseconds();
  (run.first_ms == 0.0 ? run.first_ms : run.ms.emplace_back()) = ms;
  run.stats = refinement.stats;
  run.hash = refinement.hash();
}

// Rounds in which every planet has its turn, so that a change of the machine's pace meets all.
void measure(const std::vector<Planet>& planets, const NamedCamera& view, const RefineOptions& options, int repeat) {
  std::vector<Run> runs(planets.size());
  for (int round = 0; round <= repeat; ++round)
    for (std::size_t i = 0; i < planets.size(); ++i)
      if (options.budget <= planets[i].refiner->full_triangles()) refine(planets[i], view.camera, options, runs[i]);
  for (std::size_t i = 0; i < planets.size(); ++i) {
    if (runs[i].ms.empty()) continue;
    const double ms = median(runs[i].ms);
    fmt::print("| {} | {} | {} | {} | {} | {} | {:.2f} | {:.2f} | {:.1f} | {} | {:016x} |\n", view.name,
               name_of(tuning_of(options).culling), options.budget, planets[i].level, runs[i].stats.triangles,
               runs[i].stats.visits, runs[i].first_ms, ms, static_cast<double>(runs[i].stats.triangles) / ms / 1e3,
               runs[0].ms.empty() ? "" : fmt::format("{:.2f}", ms / median(runs[0].ms)), runs[i].hash);
  }
}

void run(const Options& options) {
  std::vector<Planet> planets;
  fmt::print("| level | triangles | file MB | open ms | held MB |\n|---|---|---|---|---|\n");
  for (const int level : options.levels) {
    file_of(level, options.folder);
    const std::uint64_t before = restart_peak().value_or(0);
    const Planet& planet = planets.emplace_back(open(level, options.folder));
    fmt::print("| {} | {} | {:.1f} | {:.2f} | {:.1f} |\n", level, planet.hierarchy->input_triangle_count(),
               planet.file_mb, planet.open_ms, static_cast<double>(peak_bytes().value_or(before) - before) / 1e6);
  }
  fmt::print(
      "\n| view | culling | budget | level | triangles | visits | first ms | ms | Mtri/s | x level {} | hash |\n",
      options.levels.front());
  fmt::print("|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const NamedCamera& view : planet_views())
    for (const Culling culling : {Culling::subtree, Culling::star})
      for (const std::size_t budget : options.budgets) {
        RefineOptions refine_options;
        refine_options.budget = budget;
        tune(refine_options).culling = culling;
        measure(planets, view, refine_options, options.repeat);
      }
}

int run(int argc, char** argv) {
  CLI::App app("What refinement costs on the same planet at several levels.", "bench_refine");
  Options options;
  options.folder = fs::temp_directory_path() / "occlod_bench";
  app.add_option("LEVELS", options.levels, "Levels of the rough planet")->capture_default_str();
  app.add_option("--budgets", options.budgets, "Triangles")->capture_default_str();
  app.add_option("--folder", options.folder, "Where the planets' hierarchies are kept")->capture_default_str();
  add_repeat_option(app, options.repeat, "Rounds after the first");
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
