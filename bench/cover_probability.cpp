// bench_cover_probability: how probable it is that a box is covered, by the models and counted: of random ellipsoids
// (fig. 3 of Guthe, Balazs and Klein 2006), or of the nodes of an HLOD.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "cover/cover_counts.h"
#include "cover/ellipsoids.h"
#include "cover/scene_nodes.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

struct Options {
  EllipsoidOptions ellipsoids;
  SceneNodesOptions nodes;
  bool json = false;
};

void add_options(CLI::App& app, Options& options) {
  EllipsoidOptions& ellipsoids = options.ellipsoids;
  SceneNodesOptions& nodes = options.nodes;
  app.add_option("--runs", ellipsoids.runs, "Images")->capture_default_str()->check(CLI::PositiveNumber);
  app.add_option("--objects", ellipsoids.objects, "Ellipsoids in each")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--largest", ellipsoids.largest, "The largest radius; the frustum reaches from 1 to 100")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 20.0));
  app.add_option("--seed", ellipsoids.seed, "Of the places and radii")->capture_default_str();
  CLI::Option* hlod = app.add_option("--hlod", nodes.hlod, "Count the nodes of this HLOD instead of ellipsoids");
  CLI::Option* scene = app.add_option("--scene", nodes.scene, "The scene that has the camera path");
  CLI::Option* path = app.add_option("--path", nodes.path, "The camera path")->needs(hlod);
  hlod->needs(scene)->needs(path);
  scene->needs(hlod);
  app.add_option("--frames", nodes.frames, "Spread evenly over the path; 0: all of it")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber)
      ->needs(hlod);
  app.add_flag("--json", options.json, "Print the result as one JSON object");
}

void count_nodes(const Options& options) {
  CoverCounts counts;
  count_scene_nodes(options.nodes, counts);
  if (!options.json) return counts.print();
  tool::Json result = {{"of", options.nodes.scene.stem().string()}, {"path", options.nodes.path}};
  result.update(counts.to_json());
  tool::print_json(result);
}

void count_random(const Options& options) {
  CoverCounts counts;
  const CoverageError error = count_ellipsoids(options.ellipsoids, counts);
  if (options.json) {
    tool::Json result = {{"of", "ellipsoids"},
                         {"images", options.ellipsoids.runs},
                         {"coverage_error", {{"mean", error.mean}, {"root_mean_square", error.root_mean_square}}}};
    result.update(counts.to_json());
    return tool::print_json(result);
  }
  counts.print();
  fmt::print("c_scr as estimated minus as it is: mean {:.3f}, root mean square {:.3f}.\n", error.mean,
             error.root_mean_square);
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) {
  using namespace occlod::bench;
  CLI::App app("How probable it is that a box is covered: models beside counts", "bench_cover_probability");
  Options options;
  add_options(app, options);
  return run_app(app, argc, argv, [&] { options.nodes.hlod.empty() ? count_random(options) : count_nodes(options); });
}
