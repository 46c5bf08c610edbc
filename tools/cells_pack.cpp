// Implements `occlod cells pack FILE.vlod SCENE -o PACKED.vlod`.
#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "cells.h"
#include "command_files.h"
#include "global_options.h"
#include "interrupt.h"
#include "occlod/build_cells.h"
#include "option_values.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

struct Options {
  std::filesystem::path file, scene, output;
  bool use_cache = true;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

void run(const Options& options) {
  handle_interrupts("cells pack");
  const SceneDescription description = describe_file(options.scene);
  CommandFiles files;
  files.add_input("the cells", options.file);
  files.add_input("the scene", options.scene);
  files.add_output("--output", options.output, ".vlod");
  static_cast<void>(open_vlod(options.file));  // first, because the scene takes longer
  const CellScene scene = load_cell_scene(description, options.scene, options.use_cache);
  const auto file = open_vlod(options.file, scene.objects, scene.names);
  Progress progress(options.progress);
  const Stopwatch stopwatch;
  const auto show = [&](double share) {
    progress.show("packing " + options.file.string(), share);
    return true;
  };
  write_interruptibly(options.output.string(), 0, progress,
                      [&] { pack_cells(*file, scene.objects, options.output, show); });
  progress.clear();
  const auto packed = open_vlod(options.output);
  const std::size_t hierarchies = hierarchy_bytes(scene.objects);
  Json result = {{"input", options.file.string()}, {"file", options.output.string()}};
  result.update(to_json(*packed));
  result["unpacked_bytes"] = file->file_bytes();
  result["hierarchy_bytes"] = hierarchies;
  result["bytes_over_hierarchies"] = static_cast<double>(packed->file_bytes()) / static_cast<double>(hierarchies);
  result["pack_ms"] = stopwatch.milliseconds();
  if (options.json) return print_json(result);
  print_lines(result);
}

}  // namespace

void add_cells_pack(CLI::App& cells) {
  CLI::App& command = *cells.add_subcommand(
      "pack", "Add the geometry that cells draw, so that no hierarchy is needed to walk through the file");
  const auto options = std::make_shared<Options>();
  add_file(command, "FILE", options->file, "Cells to pack, .vlod")->required();
  add_file(command, "SCENE", options->scene, "What they were built of: a scene (.json), a mesh or an .olod file")
      ->required();
  add_file(command, "-o,--output", options->output, "File to write, .vlod")->required();
  command.callback([options, &command] {
    read_global_options(command,
                        {.json = &options->json, .progress = &options->progress, .use_cache = &options->use_cache});
    run(*options);
  });
}

}  // namespace occlod::tool
