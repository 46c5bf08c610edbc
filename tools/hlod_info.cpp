// Implements `occlod hlod info FILE.ohlod`.
#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "global_options.h"
#include "hlod.h"
#include "occlod/node_store.h"
#include "option_values.h"

namespace occlod::tool {
namespace {

struct Options {
  std::string file;
  bool all = false;
  bool json = false;
};

void run(const Options& options) {
  const OhlodFile file = read_ohlod(options.file);
  if (options.all) file.hlod.require_all();
  const hlod::HlodView& view = file.hlod.data();
  Json result = {{"file", options.file}, {"format", file.version}};
  result.update(counts_of(file.hlod));
  result["compressed"] = file.compression != OlodCompression::none;
  result.update(file_size_of(options.file, file.hlod));
  result["normals"] = view.has_normals;
  result["colors"] = view.has_colors;
  result["features"] = view.features.names.size();
  result["box"] = to_json(view.box, view.origin);
  result["level"] = levels_of(file.hlod);
  result["report"] = to_json(file.report);
  if (options.json) return print_json(result);
  print_lines(result);
  print_lines(file.report);
  print_levels(result["level"]);
}

}  // namespace

void add_hlod_info(CLI::App& hlod) {
  CLI::App& command = *hlod.add_subcommand("info", "Describe the nodes of an .ohlod file, level by level");
  const auto options = std::make_shared<Options>();
  add_file(command, "FILE", options->file, "An .ohlod file")->required();
  command.add_flag("--all", options->all, "Read and check the meshes and splits of all nodes too");
  command.callback([options, &command] {
    read_global_options(command, {.json = &options->json});
    run(*options);
  });
}

}  // namespace occlod::tool
