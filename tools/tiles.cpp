// Implements `occlod tiles INPUT... -o OUTPUT`: 3D Tiles 1.1 with glTF contents, of meshes, a scene or an HLOD, in a
// folder or an archive.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command_files.h"
#include "commands.h"
#include "global_options.h"
#include "hlod.h"
#include "interrupt.h"
#include "map_system.h"
#include "mesh/image_files.h"
#include "occlod/base.h"
#include "occlod/node_store.h"
#include "option_values.h"
#include "peak_bytes.h"
#include "stopwatch.h"
#include "tileset_output.h"

namespace occlod::tool {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> inputs;
  TilesetOutput output;
  std::string crs;  // empty: coordinates are those of no map
  hlod::HlodBuildOptions build = tiles::build_options();
  std::optional<std::size_t> memory;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

bool is_hlod(const Options& options) {
  return options.inputs.size() == 1 && fs::path(options.inputs[0]).extension() == ".ohlod";
}

// All of the output is replaced, so no input may be it or lie in it.
void refuse_inputs_in(const TilesetOutput& output, const std::vector<std::string>& inputs) {
  std::error_code ignored;
  const fs::path whole = fs::weakly_canonical(output.path, ignored);
  for (const std::string& input : inputs) {
    const fs::path file = fs::weakly_canonical(input, ignored);
    if (std::mismatch(whole.begin(), whole.end(), file.begin(), file.end()).first == whole.end())
      throw CLI::ValidationError("--output", "holds an input, " + shown(input) + "; choose another name");
  }
}

// Returns the folder in which the output is made, whether its name ends in a slash or not.
fs::path folder_beside(fs::path output) {
  if (!output.has_filename()) output = output.parent_path();
  return folder_of(output);
}

void check(const Options& options, const CLI::App& command) {
  if (is_hlod(options))
    for (const char* const option : {"--node-triangles", "--crs"})
      if (command.count(option) > 0)
        throw CLI::ValidationError(option, "goes with meshes only: an .ohlod file is built already");
  refuse_inputs_in(options.output, options.inputs);
  check(options.output);
}

void run(const Options& options) {
  handle_interrupts("tiles");
  Progress progress(options.progress);
  Stopwatch stopwatch;
  const std::unique_ptr<MapSystem> map =
      options.crs.empty() ? nullptr : find_map_system(options.crs, options.inputs[0], options.build.threads);
  TilesetOutput output = options.output;
  std::optional<MemoryLimit> limit;  // ends after what it holds
  if (options.memory) limit.emplace(*options.memory, folder_beside(options.output.path));
  BuiltHlod built;
  if (is_hlod(options)) {
    OhlodFile file = read_nested_ohlod(options.inputs[0]);
    built.hlod = std::move(file.hlod);
    built.report = std::move(file.report);
    built.read_ms = stopwatch.milliseconds();
  } else {
    hlod::HlodBuildOptions build = options.build;
    build.progress = [&progress, what = "building " + options.output.path](double done) {
      progress.show(what, done);
      return true;
    };
    built = build_from_files(options.inputs, limit.has_value(), build, progress, {map.get(), output.tileset.up});
  }
  if (map) {
    output.tileset.origin = map->place();
    output.tileset.up = UpAxis::z;
  }
  const double build_ms = stopwatch.restart() - built.read_ms;
  Json result = {{"inputs", options.inputs}};
  result.update(write_tileset(output, built.hlod, folder_of(options.inputs[0]), progress));
  if (map) result.update(map->told());
  if (!limit) result["read_ms"] = built.read_ms;
  if (!is_hlod(options)) result["build_ms"] = build_ms;
  result["write_ms"] = stopwatch.milliseconds();
  result["peak_bytes"] = peak_bytes();
  if (limit) result["scratch_bytes"] = limit->max_scratch_bytes();
  print_result(result, built.report.left_out, options.json);
}

}  // namespace

void add_tiles(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("tiles", "Write meshes, a scene or an .ohlod file as 3D Tiles");
  const auto options = std::make_shared<Options>();
  add_file(command, "INPUT", options->inputs,
           "Meshes (.ply, .obj, .off, .stl, .gltf or .glb), a scene (.json), or an .ohlod file of nested groups")
      ->required();
  add_tileset_output(command, options->output);
  add_name(command, "--crs", options->crs,
           "The projected system of the input's coordinates, such as EPSG:32633, or EPSG:32633+5773 with heights above "
           "the sea; else heights are above the WGS84 ellipsoid")
      ->excludes("--origin");
  add_node_triangles(command, options->build.node_triangles);
  add_memory(command, options->memory, min_build_memory,
             "Stream meshes and keep to so much main memory, e.g. 1G: what does not fit lies in scratch files beside "
             "OUTPUT");
  command.callback([options, &command] {
    read_global_options(command,
                        {.json = &options->json, .progress = &options->progress, .threads = &options->build.threads});
    options->output.tileset.threads = options->build.threads;
    check(*options, command);
    run(*options);
  });
}

}  // namespace occlod::tool
