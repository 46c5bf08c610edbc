// bench_hlod_build: how quickly HLODs are built beside hierarchies, and how many triangles their levels cost beside
// direct simplification.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "measure/surface_distance.h"
#include "occlod/build_hierarchy.h"
#include "occlod/build_hlod.h"
#include "occlod/hlod.h"
#include "stopwatch.h"
#include "support/bench_meshes.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

using hlod::Borders;
using hlod::Grouping;
using hlod::Hlod;
using hlod::NodeId;
using hlod::Within;

struct Options {
  std::vector<std::string> meshes = {"planet:8",
                                     "planet:9",
                                     "scans/armadillo_100k.obj",
                                     "scans/turbineblade.ply",
                                     "scans/dragon_vrip_res2.ply",
                                     "scenes/hospital_electrical.ply",
                                     "scenes/ww2-cityscene.ply",
                                     "scenes/sponza.obj"};
  std::size_t samples = 100'000;
  std::size_t fronts = 10'000;
  int repeat = 3;
  int threads = 0;
  bool only_time = false;
};

struct Kind {
  const char* name;
  Grouping grouping;
  Borders borders;
  Within within;
};
constexpr Kind kinds[] = {{"shifted", Grouping::shifted, Borders::locked, Within::geomorph},
                          {"shifted, splits", Grouping::shifted, Borders::locked, Within::splits},
                          {"nested, free", Grouping::nested, Borders::free, Within::geomorph},
                          {"nested, locked", Grouping::nested, Borders::locked, Within::geomorph}};

// The least of several rounds, in seconds.
struct Times {
  double wall = std::numeric_limits<double>::infinity();
  double processor = std::numeric_limits<double>::infinity();
};

template <typename Work>
void time(Times& least, const Work& work) {
  const tool::Stopwatch watch;
  const std::clock_t start = std::clock();
  work();
  least.processor = std::min(least.processor, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  least.wall = std::min(least.wall, 1e-3 * watch.milliseconds());
}

TriangleMesh level_mesh(const Hlod& hlod, std::size_t index) {
  TriangleMesh mesh;
  const hlod::Level& level = hlod.data().levels[index];
  for (NodeId n = level.first_node; n < level.first_node + level.node_count; ++n) {
    const hlod::NodeMesh node = hlod.mesh(n);
    const auto first = static_cast<VertexId>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), node.positions.begin(), node.positions.end());
    for (std::size_t i = 0; i < node.indices.size(); i += 3)
      mesh.triangles.emplace_back(first + node.indices[i], first + node.indices[i + 1], first + node.indices[i + 2]);
  }
  return mesh;
}

class Quality {
 public:
  Quality(const TriangleMesh& mesh, const Hierarchy& hierarchy, std::size_t samples)
      : input_(mesh.positions, mesh.triangles), hierarchy_(hierarchy), samples_(samples) {}

  // Triangles of the mesh to those of the cut of the hierarchy that is as far from the input (RMS, both ways), between
  // whose two neighbours in a series of cuts it is interpolated. None where the series does not reach so far.
  [[nodiscard]] std::optional<double> triangles_to_direct(const TriangleMesh& mesh) {
    const double wanted = std::log(rms(mesh));
    std::optional<std::pair<double, double>> finer;  // logarithms of triangles and RMS
    for (double share = 2.9; share > 0.45; share /= 1.2) {
      const TriangleMesh cut = cut_mesh(
          hierarchy_,
          cut_to_triangles(hierarchy_, static_cast<std::size_t>(share * static_cast<double>(mesh.triangle_count()))));
      const std::pair here(std::log(static_cast<double>(cut.triangle_count())), std::log(rms(cut)));
      if (finer && finer->second <= wanted && wanted <= here.second) {
        const double way = (wanted - finer->second) / std::max(here.second - finer->second, 1e-12);
        const double direct = std::exp(finer->first + way * (here.first - finer->first));
        return static_cast<double>(mesh.triangle_count()) / direct;
      }
      finer = here;
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] double rms(const TriangleMesh& mesh) const {
    const measure::Surface surface(mesh.positions, mesh.triangles);
    return measure::surface_distance(input_, surface, {samples_, 1}).rms();
  }

  measure::Surface input_;
  const Hierarchy& hierarchy_;
  std::size_t samples_;
};

std::string levels_to_direct(const Hlod& hlod, Quality& quality) {
  constexpr std::size_t fewest_triangles = 500;  // below that single triangles decide
  std::vector<std::string> ratios;
  for (std::size_t level = 1; level < hlod.level_count(); ++level) {
    const TriangleMesh mesh = level_mesh(hlod, level);
    if (mesh.triangle_count() < fewest_triangles) break;
    const std::optional<double> ratio = quality.triangles_to_direct(mesh);
    ratios.push_back(ratio ? fmt::format("{:.2f}", *ratio) : "-");
  }
  return fmt::format("{}", fmt::join(ratios, " "));
}

void print_rows(const std::string& name, const Options& options) {
  const TriangleMesh mesh = load_bench_mesh(name);
  Times direct, times[std::size(kinds)];
  Hierarchy hierarchy;
  Hlod hlods[std::size(kinds)];
  BuildOptions direct_options;
  direct_options.threads = options.threads;
  for (int round = 0; round < options.repeat; ++round) {  // in turn, so that other programs disturb all alike
    time(direct, [&] { hierarchy = build_hierarchy(mesh, direct_options); });
    for (std::size_t k = 0; k < std::size(kinds); ++k) {
      hlod::HlodBuildOptions build;
      build.grouping = kinds[k].grouping;
      build.borders = kinds[k].borders;
      build.within = kinds[k].within;
      build.threads = options.threads;
      time(times[k], [&] { hlods[k] = build_hlod(mesh, build); });
    }
  }
  std::optional<Quality> quality;
  if (!options.only_time) quality.emplace(mesh, hierarchy, options.samples);
  const double triangles = static_cast<double>(mesh.triangle_count());
  for (std::size_t k = 0; k < std::size(kinds); ++k) {
    double stored = 0.0;
    for (const hlod::Node& node : hlods[k].data().nodes) stored += node.triangles;
    // Fronts with cuts within nodes are summed up triangle by triangle.
    const std::size_t fronts = kinds[k].within == Within::splits ? options.fronts / 10 : options.fronts;
    const std::size_t violations = validate(hlods[k], fronts).size();
    fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {} | {} | {:.2f} | {:.1f} | {} | {} |\n", name, kinds[k].name,
               times[k].wall, 1e6 * times[k].processor / triangles, direct.wall / times[k].wall, hlods[k].node_count(),
               hlods[k].data().roots.size(), stored / triangles, static_cast<double>(hlods[k].bytes()) / triangles,
               violations, quality ? levels_to_direct(hlods[k], *quality) : "");
    std::fflush(stdout);
  }
}

void run(const Options& options) {
  fmt::print(
      "| mesh | groups | s | us/triangle | speed / build_hierarchy | nodes | roots | stored | bytes/triangle | "
      "violations | triangles / direct, level by level |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& name : available(options.meshes)) print_rows(name, options);
}

int run(int argc, char** argv) {
  CLI::App app("HLODs: time to build, size, cracks, and what their levels cost.", "bench_hlod_build");
  Options options;
  app.add_option("MESHES", options.meshes, "Files in folders of OCCLOD_MESHES, or planet:LEVEL")->capture_default_str();
  app.add_option("--samples", options.samples, "Points on each surface")->capture_default_str();
  app.add_option("--fronts", options.fronts, "Random fronts of each HLOD; a tenth with splits")->capture_default_str();
  app.add_option("--threads", options.threads, "Of all builds; 0: one per core")->capture_default_str();
  app.add_option("--repeat", options.repeat, "Builds; times are the least")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_flag("--only-time", options.only_time, "Do not compare levels with direct simplification");
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
