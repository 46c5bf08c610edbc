// bench_wedges: how far textures slip when meshes are simplified, beside meshoptimizer.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/timing.h"
#include "occlod/scene.h"
#include "support/run_app.h"
#include "wedges/scores.h"
#include "wedges/simplifiers.h"
#include "wedges/subjects.h"
#include "wedges/tables.h"

namespace occlod::bench {
namespace {

struct Options {
  std::vector<std::string> meshes = {
      "textured/spot.obj", "textured/beast.obj", "scenes/sponza.obj", "cylinder", "charts", "fragmented"};
  std::vector<std::string> tools = {"occlod", "meshoptimizer"};
  std::vector<double> percents = {50, 25, 10, 5, 2.5, 1, 0.5};
  std::vector<std::size_t> counts = {10'000, 64};
  ScoreOptions scores;
  int repeat = 1;
  std::string with;
  std::string csv;
};

struct Target {
  std::size_t triangles;
  bool with_pictures;
};

// Those that are simplifications. Pictures at 10 and 1 percent and at the counts.
std::vector<Target> targets_for(const TriangleMesh& mesh, const Options& options) {
  std::vector<Target> targets;
  for (const double percent : options.percents)
    targets.push_back({static_cast<std::size_t>(percent / 100.0 * static_cast<double>(mesh.triangle_count())),
                       percent == 10.0 || percent == 1.0});
  for (const std::size_t count : options.counts) targets.push_back({count, true});
  std::erase_if(targets, [&](const Target& t) { return t.triangles < 4 || t.triangles >= mesh.triangle_count(); });
  std::sort(targets.begin(), targets.end(), [](const Target& a, const Target& b) { return a.triangles > b.triangles; });
  return targets;
}

std::vector<WedgeSimplifier> simplifiers(const Options& options) {
  std::vector<WedgeSimplifier> result;
  const auto add = [&](const std::vector<WedgeSimplifier>& more) {
    result.insert(result.end(), more.begin(), more.end());
  };
  for (const std::string& tool : options.tools) {
    if (tool == "occlod") add(occlod_simplifiers());
#ifdef OCCLOD_HAS_MESHOPTIMIZER
    if (tool == "meshoptimizer") add(meshoptimizer_simplifiers());
#else
    if (tool == "meshoptimizer") fmt::print(stderr, "SKIPPED: meshoptimizer was not there when this was built\n");
#endif
  }
  return result;
}

std::vector<WedgeRow> rows_of(const std::string& name, const WedgeSimplifier& simplifier, const TriangleMesh& mesh,
                              const WedgeScorer& scorer, const Options& options) {
  const std::vector<Target> targets = targets_for(mesh, options);
  std::vector<std::size_t> counts;
  for (const Target& target : targets) counts.push_back(target.triangles);
  std::vector<std::vector<double>> milliseconds(targets.size());
  std::vector<WedgeRun> runs;
  for (int round = 0; round < options.repeat; ++round) {
    runs = simplifier.simplify(mesh, counts);
    for (std::size_t i = 0; i < runs.size(); ++i) milliseconds[i].push_back(runs[i].milliseconds);
  }
  std::vector<WedgeRow> rows;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    WedgeRow row;
    row.mesh = name;
    row.tool = simplifier.tool;
    row.variant = simplifier.variant;
    row.target = targets[i].triangles;
    row.milliseconds = median(milliseconds[i]);
    scorer.score(row, runs[i], targets[i].with_pictures);
    rows.push_back(std::move(row));
  }
  return rows;
}

void run(const Options& options) {
  const std::vector<WedgeSimplifier> tools = simplifiers(options);
#ifdef OCCLOD_HAS_MESHOPTIMIZER
  fmt::print("meshoptimizer {}\n\n", meshoptimizer_version());
#endif
  std::vector<WedgeRow> rows;
  if (!options.with.empty()) rows = read_csv(options.with);
  for (const std::string& name : available_textured(options.meshes)) {
    const TriangleMesh mesh = load_textured_mesh(name);
    fmt::print(stderr, "{}: {} triangles, {} vertices, {} wedges\n", name, mesh.triangle_count(), mesh.vertex_count(),
               mesh.wedge_count());
    if (mesh.texture_coordinates.empty()) {
      fmt::print(stderr, "SKIPPED: {} has no texture coordinates\n", name);
      continue;
    }
    const WedgeScorer scorer(mesh, find_mesh(name, {}).parent_path().string(), options.scores);
    for (const WedgeSimplifier& tool : tools) {
      const std::vector<WedgeRow> more = rows_of(name, tool, mesh, scorer, options);
      rows.insert(rows.end(), more.begin(), more.end());
    }
  }
  fmt::print("{}\n{}\nhash of all results: {:016x}\n", best_table(rows), equal_error_table(rows), hash_of(rows));
  if (options.csv.empty()) return;
  std::ofstream file(options.csv);
  file << csv_of(rows) << std::flush;
  if (!file) throw std::runtime_error(options.csv + ": cannot be written");
}

int run(int argc, char** argv) {
  CLI::App app("How far textures slip when meshes are simplified, beside meshoptimizer.", "bench_wedges");
  Options options;
  app.add_option("MESHES", options.meshes, "Files in folders of OCCLOD_MESHES, or cylinder, charts, fragmented")
      ->capture_default_str();
  app.add_option("--tools", options.tools, "What simplifies")
      ->capture_default_str()
      ->check(CLI::IsMember({"occlod", "meshoptimizer"}));
  app.add_option("--percents", options.percents, "Targets, in percent of the triangles")->capture_default_str();
  app.add_option("--counts", options.counts, "Targets, in triangles")->capture_default_str();
  app.add_option("--samples", options.scores.samples, "Points on each surface")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--size", options.scores.size_px, "Pixels along each side of the pictures")
      ->capture_default_str()
      ->check(CLI::Range(16, 4096));
  add_repeat_option(app, options.repeat, "Runs");
  app.add_option("--with", options.with, "Read rows that an earlier run wrote, and put them in front");
  app.add_option("--csv", options.csv, "Write all rows");
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
