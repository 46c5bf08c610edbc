// Implements `occlod validate FILE.olod [--input MESH]`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "global_options.h"
#include "occlod/build_hierarchy.h"
#include "occlod/mesh_file.h"
#include "option_values.h"
#include "validation.h"

namespace occlod::tool {
namespace {

constexpr int max_cuts = 1'000'000;

struct Options {
  std::string file;
  std::string input;
  int cuts = 16;
  bool json = false;
};

void run(const Options& options) {
  const OlodFile file = read_olod(options.file);
  std::vector<std::string> violations = validate(file.hierarchy, options.cuts);
  if (!options.input.empty() && !restores(file.hierarchy, read_mesh(options.input).mesh))
    violations.push_back(fmt::format("full refinement is not the mesh {}", options.input));
  report({options.file, std::move(violations), file.report.left_out, "mesh"}, options.json);
}

}  // namespace

void add_validate(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("validate", "Check every invariant of a hierarchy");
  const auto options = std::make_shared<Options>();
  add_file(command, "FILE", options->file, "Hierarchy to check, an .olod file")->required();
  add_file(command, "--input", options->input, "Also check that all splits together give back this mesh");
  add_number(command, "--cuts", options->cuts, WholeRange{0, max_cuts}, "Number of random cuts to check for cracks")
      ->capture_default_str();
  command.callback([options, &command] {
    read_global_options(command, {.json = &options->json});
    run(*options);
  });
}

}  // namespace occlod::tool
