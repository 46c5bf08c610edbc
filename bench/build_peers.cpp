// bench_build_peers: building a hierarchy beside simplifying with other tools, speed and quality in one table.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "measure/surface_distance.h"
#include "peers/peers.h"
#include "peers/peers_table.h"
#include "support/bench_meshes.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

constexpr char reference[] = "meshoptimizer";

struct Options {
  std::vector<std::string> meshes = {"planet:8", "planet:9", "scans/armadillo_100k.obj", "scans/turbineblade.ply"};
  std::vector<std::string> tools = {"occlod", reference, "OpenMesh"};
  int repeat = 5;
  int slow_repeat = 1;
  std::string json;
};

struct Peer {
  std::string tool;  // as --tools names it
  std::string name;
  Simplify* simplify;
  bool is_slow = false;  // tens of seconds a run
};

std::vector<Peer> all_peers() {
  std::vector<Peer> result = {{"occlod", "occlod", simplify_by_occlod}};
  if (const unsigned cores = std::thread::hardware_concurrency(); cores > 1)
    result.push_back({"occlod", fmt::format("occlod, {} threads", cores), simplify_by_occlod_threads});
#ifdef OCCLOD_HAS_MESHOPTIMIZER
  result.push_back({reference, reference, simplify_by_meshoptimizer});
#endif
#ifdef OCCLOD_HAS_OPENMESH
  result.push_back({"OpenMesh", "OpenMesh", simplify_by_openmesh, true});
#endif
  return result;
}

// Those that are asked for and were there when this was built.
std::vector<Peer> peers(const std::vector<std::string>& tools) {
  std::vector<Peer> result;
  for (const std::string& tool : tools) {
    const std::size_t before = result.size();
    for (Peer& peer : all_peers())
      if (peer.tool == tool) result.push_back(std::move(peer));
    if (result.size() == before) fmt::print(stderr, "SKIPPED: {} was not there when this was built\n", tool);
  }
  return result;
}

// One percent of the triangles, and 10,000 where that is a simplification.
std::vector<std::size_t> targets_for(const TriangleMesh& mesh) {
  std::vector<std::size_t> targets = {std::max<std::size_t>(mesh.triangle_count() / 100, 4)};
  if (mesh.triangle_count() > 10'000) targets.push_back(10'000);
  return targets;
}

void measure_quality(PeerRow& row, const measure::Surface& input, const TriangleMesh& result) {
  const measure::Surface surface(result.positions, result.triangles);
  const measure::SurfaceDistance distance = measure::surface_distance(input, surface);
  row.rms_percent = 100.0 * distance.rms() / input.diagonal();
  row.max_percent = 100.0 * distance.farther().max / input.diagonal();
}

// Rows by target, then by tool. In each round every tool has its turn, so that a change of the machine's pace meets
// all.
std::vector<PeerRow> rows_for(const std::string& name, const std::vector<Peer>& tools, const Options& options) {
  const TriangleMesh mesh = load_bench_mesh(name);
  const measure::Surface input(mesh.positions, mesh.triangles);
  const std::vector<std::size_t> targets = targets_for(mesh);
  std::vector<PeerRow> rows;
  for (const std::size_t target : targets)
    for (const Peer& tool : tools) rows.push_back({name, mesh.triangle_count(), target, tool.name, 0, {}, 0.0, 0.0});
  for (int round = 0; round < options.repeat; ++round) {
    for (std::size_t t = 0; t < tools.size(); ++t) {
      if (tools[t].is_slow && round >= options.slow_repeat) continue;
      const std::vector<SimplifyRun> runs = tools[t].simplify(mesh, targets);
      for (std::size_t i = 0; i < targets.size(); ++i) {
        PeerRow& row = rows[i * tools.size() + t];
        row.milliseconds.push_back(runs[i].milliseconds);
        row.triangles = runs[i].result.triangle_count();
        if (round == 0) measure_quality(row, input, runs[i].result);
      }
    }
  }
  return rows;
}

void run(const Options& options) {
  const std::vector<Peer> tools = peers(options.tools);
  std::vector<PeerRow> rows;
  for (const std::string& name : available(options.meshes)) {
    fmt::print(stderr, "{}\n", name);
    const std::vector<PeerRow> more = rows_for(name, tools, options);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  fmt::print("{}", format_table(rows, reference));
  if (options.json.empty()) return;
  std::ofstream file(options.json);
  file << format_json(rows, reference) << std::flush;
  if (!file) throw std::runtime_error(options.json + ": cannot be written");
}

int run(int argc, char** argv) {
  CLI::App app("Building a hierarchy beside simplifying with other tools: speed and quality.", "bench_build_peers");
  Options options;
  app.add_option("MESHES", options.meshes, "Files in folders of OCCLOD_MESHES, or planet:LEVEL")->capture_default_str();
  app.add_option("--tools", options.tools, "What simplifies")
      ->capture_default_str()
      ->check(CLI::IsMember({"occlod", reference, "OpenMesh"}));
  add_repeat_option(app, options.repeat, "Rounds");
  app.add_option("--slow-repeat", options.slow_repeat, "Rounds in which slow tools take part")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--json", options.json, "Write the table, with the time of every run, as JSON");
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
