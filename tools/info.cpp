// occlod info FILE.olod
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>

#include "commands.h"
#include "json_output.h"
#include "occlod/io/olod.h"

namespace occlod::tool {
namespace {

struct Options {
  std::string file;
  bool json = false;
};

std::uint32_t forest_levels(const Hierarchy& hierarchy) {
  std::uint32_t levels = 0;
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) levels = std::max(levels, hierarchy.node(s).level + 1);
  return levels;
}

void run(const Options& options) {
  const OlodFile file = read_olod(options.file);
  const Hierarchy& hierarchy = file.hierarchy;
  Json result = {{"file", options.file}, {"format", olod_version}};
  result.update(counts_of(hierarchy));
  result["dependencies"] = hierarchy.data().dependencies.size();
  result["levels"] = forest_levels(hierarchy);
  result["normals"] = !hierarchy.data().normals.empty();
  result["colors"] = !hierarchy.data().colors.empty();
  result["box"] = {{"min", to_json(glm::dvec3(hierarchy.box().min))},
                   {"max", to_json(glm::dvec3(hierarchy.box().max))}};
  result["report"] = to_json(file.report);
  if (options.json) return print_json(result);
  print_lines(result);
  print_lines(result["report"]);
}

}  // namespace

void add_info(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("info", "Say what a hierarchy holds");
  const auto options = std::make_shared<Options>();
  command.add_option("FILE", options->file, "An .olod file")->required();
  command.add_flag("--json", options->json, "Print one JSON object");
  command.callback([options] { run(*options); });
}

}  // namespace occlod::tool
