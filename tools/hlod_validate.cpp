// Implements `occlod hlod validate FILE.ohlod [--input INPUT...]`.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "global_options.h"
#include "hlod.h"
#include "occlod/hlod.h"
#include "occlod/node_store.h"
#include "option_values.h"
#include "validation.h"

namespace occlod::tool {
namespace {

constexpr int max_fronts = 1'000'000;

struct Options {
  std::string file;
  std::vector<std::string> inputs;
  std::size_t fronts = 64;
  bool leaves_only = false;
  bool json = false;
};

bool is_of_input(const Options& options, const hlod::Hlod& hlod, Progress& progress) {
  if (options.leaves_only) return restores(hlod, stream_hlod_input(options.inputs, progress));
  return restores(hlod, read_hlod_input(options.inputs, progress).mesh);
}

void run(const Options& options) {
  const OhlodFile file = read_ohlod(options.file);
  std::vector<std::string> violations;
  if (!options.leaves_only) violations = validate(file.hlod, options.fronts);
  Progress progress(ShowProgress::never);
  if (!options.inputs.empty() && !is_of_input(options, file.hlod, progress))
    violations.push_back(fmt::format("level 0 is not {}", fmt::join(options.inputs, " and ")));
  report({options.file, std::move(violations), file.report.left_out, "input"}, options.json);
}

}  // namespace

void add_hlod_validate(CLI::App& hlod) {
  CLI::App& command = *hlod.add_subcommand("validate", "Check every invariant of an .ohlod file");
  const auto options = std::make_shared<Options>();
  add_file(command, "FILE", options->file, "File to check, .ohlod")->required();
  CLI::Option* const input =
      add_file(command, "--input", options->inputs, "Also check that level 0 is this scene or mesh, or these meshes");
  command
      .add_flag("--leaves-only", options->leaves_only,
                "Check nothing else, by a hash of all triangles' positions, one piece of the input in memory at a time")
      ->needs(input);
  add_number(command, "--fronts", options->fronts, WholeRange{0, max_fronts},
             "Number of random fronts to check for cracks")
      ->capture_default_str();
  command.callback([options, &command] {
    read_global_options(command, {.json = &options->json});
    run(*options);
  });
}

}  // namespace occlod::tool
