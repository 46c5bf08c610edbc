// occlod validate FILE.olod [--input MESH]
#include "occlod/hierarchy/validate.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "json_output.h"
#include "occlod/core/error.h"
#include "occlod/io/olod.h"
#include "occlod/io/read_mesh.h"

namespace occlod::tool {
namespace {

struct Options {
  std::string file;
  std::string input;
  ValidateOptions validate;
  bool json = false;
};

void run(const Options& options) {
  const OlodFile file = read_olod(options.file);
  std::vector<std::string> violations = validate(file.hierarchy, options.validate);
  if (!options.input.empty() && !restores(file.hierarchy, read_mesh(options.input).mesh))
    violations.push_back(fmt::format("full refinement is not the mesh {}", options.input));

  if (options.json)
    print_json({{"file", options.file},
                {"valid", violations.empty()},
                {"violations", violations},
                {"left_out", to_json(file.report.left_out)}});
  else if (violations.empty())
    fmt::print("{}: valid (left out of its mesh: {})\n", options.file, in_words(file.report.left_out));
  else
    for (const std::string& violation : violations) fmt::print("{}: {}\n", options.file, violation);
  if (!violations.empty())
    throw Error({options.file, "", fmt::format("{} violations", violations.size()), "build it again"});
}

}  // namespace

void add_validate(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("validate", "Check every invariant of a hierarchy");
  const auto options = std::make_shared<Options>();
  command.add_option("FILE", options->file, "An .olod file")->required();
  command.add_option("--input", options->input, "The mesh that full refinement has to give back");
  command.add_option("--cuts", options->validate.random_cuts, "Random refinements that are checked for cracks")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  command.add_flag("--json", options->json, "Print one JSON object");
  command.callback([options] { run(*options); });
}

}  // namespace occlod::tool
