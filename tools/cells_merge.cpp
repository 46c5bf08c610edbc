// Implements `occlod cells merge DIR -o FILE.vlod`.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <vector>

#include "cells.h"
#include "command_files.h"
#include "global_options.h"
#include "interrupt.h"
#include "occlod/base.h"
#include "occlod/build_cells.h"
#include "option_values.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

struct Options {
  std::filesystem::path folder;
  std::filesystem::path output;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

void run(const Options& options) {
  handle_interrupts("cells merge");
  const std::vector<std::filesystem::path> parts = cell_parts_in(options.folder);
  if (parts.empty())
    throw Error({options.folder.string(), "", "has no .vpart files", "make some with 'occlod cells build --work'"});
  CommandFiles files;
  for (const std::filesystem::path& part : parts) files.add_input("a part", part);
  files.add_output("--output", options.output, ".vlod");
  Progress progress(options.progress);
  progress.show("merging " + options.folder.string(), std::nullopt);
  const Stopwatch stopwatch;
  write_interruptibly(options.output.string(), 0, progress, [&] { merge_cells(parts, options.output); });
  progress.clear();
  Json result = {{"parts", parts.size()}, {"file", options.output.string()}};
  result.update(to_json(*open_vlod(options.output)));
  result["merge_ms"] = stopwatch.milliseconds();
  if (options.json) return print_json(result);
  print_lines(result);
}

}  // namespace

void add_cells_merge(CLI::App& cells) {
  CLI::App& command = *cells.add_subcommand("merge", "Make a file of the parts that 'cells build --work' has written");
  const auto options = std::make_shared<Options>();
  add_file(command, "FOLDER", options->folder, "Folder with the parts of one build")->required();
  add_file(command, "-o,--output", options->output, "File to write, .vlod")->required();
  command.callback([options, &command] {
    read_global_options(command, {.json = &options->json, .progress = &options->progress});
    run(*options);
  });
}

}  // namespace occlod::tool
