// Implements `occlod hlod export FILE.ohlod -o FOLDER`: 3D Tiles 1.1 with glTF contents.
#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "global_options.h"
#include "hlod.h"
#include "interrupt.h"
#include "mesh/image_files.h"
#include "occlod/base.h"
#include "occlod/node_store.h"
#include "option_values.h"
#include "peak_bytes.h"
#include "stopwatch.h"
#include "tileset_output.h"

namespace occlod::tool {
namespace {

constexpr std::uint64_t max_tiles_per_file = 1'000'000;

struct Options {
  std::string file;
  TilesetOutput output;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

void run(const Options& options) {
  handle_interrupts("hlod export");
  check(options.output);
  const Stopwatch stopwatch;
  const OhlodFile file = read_nested_ohlod(options.file);
  Progress progress(options.progress);
  Json result = {{"file", options.file}};
  result.update(write_tileset(options.output, file.hlod, folder_of(options.file), progress));
  result["write_ms"] = stopwatch.milliseconds();
  result["peak_bytes"] = peak_bytes();
  print_result(result, file.report.left_out, options.json);
}

}  // namespace

void add_hlod_export(CLI::App& hlod) {
  CLI::App& command = *hlod.add_subcommand("export", "Write an .ohlod file of nested groups as 3D Tiles");
  const auto options = std::make_shared<Options>();
  add_file(command, "FILE", options->file, "An .ohlod file, built with --grouping nested --borders free")->required();
  add_tileset_output(command, options->output);
  add_number(command, "--tiles-per-file", options->output.tiles_per_file, WholeRange{1, max_tiles_per_file},
             "The most tiles in a .json file; more go on in others")
      ->capture_default_str();
  command.callback([options, &command] {
    read_global_options(command, {.json = &options->json, .progress = &options->progress});
    run(*options);
  });
}

}  // namespace occlod::tool
