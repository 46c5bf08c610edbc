// occlod cells check FILE.vlod SCENE
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "cell_sight.h"
#include "cells.h"
#include "mesh/portable_math.h"
#include "occlod/core/error.h"
#include "option_values.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

constexpr std::uint64_t most_eyes = 1'000'000, most_image = 8192;

struct Options {
  std::filesystem::path file, scene;
  std::uint64_t cells = 16;
  CellEyes eyes{50, 256, 1};
  bool use_cache = true;
  bool json = false;
};

// Evenly random, each once, ascending; all where there are no more.
std::vector<CellId> sample(const CellTree& tree, std::uint64_t count, std::uint64_t seed) {
  std::vector<CellId> leaves;
  for (CellId n = 0; n < tree.nodes().size(); ++n)
    if (tree.is_leaf(n)) leaves.push_back(n);
  if (leaves.size() <= count) return leaves;
  RandomStream random(seed);
  std::set<CellId> chosen;
  while (chosen.size() < count)
    chosen.insert(leaves[static_cast<std::size_t>(random.below(static_cast<int>(leaves.size())))]);
  return {chosen.begin(), chosen.end()};
}

void print_header() {
  fmt::print("{:>8}  {:>10}  {:>10}  {:>10}  {:>11}\n", "cell", "drawn", "pixels", "backs", "unexplained");
}

void print_row(const Json& cell) {
  fmt::print("{:>8}  {:>10}  {:>10}  {:>10}  {:>11}\n", cell["cell"].get<CellId>(),
             cell["drawn_triangles"].get<std::size_t>(), cell["pixels"].get<std::size_t>(),
             cell["backs"].get<std::size_t>(), cell["unexplained"].get<std::size_t>());
}

void run(const Options& options) {
  const SceneDescription description = describe_file(options.scene);
  static_cast<void>(open_vlod(options.file));  // before the scene, which takes longer
  const CellScene scene = load_cell_scene(description, options.scene, options.use_cache);
  const auto file = open_vlod(options.file, scene.objects, scene.names);
  const FullScene full(scene.objects);
  const Stopwatch stopwatch;
  CellSight all;
  Json cells = Json::array();
  CellEyes eyes = options.eyes;
  if (!options.json) print_header();
  for (const CellId cell : sample(file->tree(), options.cells, options.eyes.seed)) {
    const std::vector<CellObjectCut> cut = read_cell(*file, scene.objects, cell);
    eyes.seed = options.eyes.seed + cell;
    const CellSight sight =
        look_from(file->tree().node(cell).box, full, scene.objects, file->options().cell, cut, eyes);
    all.pixels += sight.pixels;
    all.backs += sight.backs;
    all.missing += sight.missing;
    cells.push_back({{"cell", cell},
                     {"drawn_triangles", file->tree().node(cell).drawn_triangles},
                     {"pixels", sight.pixels},
                     {"backs", sight.backs},
                     {"unexplained", sight.missing}});
    if (!options.json) print_row(cells.back());
  }
  Json result = {{"file", options.file.string()},
                 {"scene", options.scene.string()},
                 {"cells_checked", cells.size()},
                 {"eyes_a_cell", 9 + options.eyes.random},
                 {"image_size", options.eyes.image_size},
                 {"seed", options.eyes.seed},
                 {"pixels", all.pixels},
                 {"backs", all.backs},
                 {"unexplained", all.missing},
                 {"check_ms", stopwatch.milliseconds()}};
  if (options.json) {
    result["cells"] = std::move(cells);
    print_json(result);
  } else {
    fmt::print("\n");
    print_lines(result);
  }
  if (all.missing > 0)
    throw Error({options.file.string(), "",
                 fmt::format("{} of {} pixels show what is not drawn", all.missing, all.pixels),
                 "build the cells again, of a hierarchy with accumulated error bounds"});
}

}  // namespace

void add_cells_check(CLI::App& cells) {
  CLI::App& command =
      *cells.add_subcommand("check", "Look from random eyes of random cells: is all that they see drawn?");
  const auto options = std::make_shared<Options>();
  add_file(command, "FILE", options->file, "File to check, .vlod")->required();
  add_file(command, "SCENE", options->scene, "What it was built of: a scene (.json), a mesh or an .olod file")
      ->required();
  add_number(command, "--cells", options->cells, WholeRange{1, most_eyes}, "Number of cells")->capture_default_str();
  add_number(command, "--eyes", options->eyes.random, WholeRange{0, most_eyes},
             "Random eyes of each, besides its corners and its middle; each looks to all six sides")
      ->capture_default_str();
  add_number(command, "--image-size", options->eyes.image_size, WholeRange{1, most_image},
             "Pixels along each side of an image")
      ->capture_default_str();
  add_number(command, "--seed", options->eyes.seed, WholeRange{}, "Random seed")->capture_default_str();
  add_no_cache(command, options->use_cache);
  command.add_flag("--json", options->json, "Print the result as one JSON object");
  command.callback([options] { run(*options); });
}

}  // namespace occlod::tool
