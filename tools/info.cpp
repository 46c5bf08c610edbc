// occlod info FILE.olod
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "json_output.h"
#include "occlod/io/olod.h"

namespace occlod::tool {
namespace {

struct Options {
  std::string file;
  bool check = false;
  bool json = false;
};

// What only a look at every split tells.
struct Counts {
  std::uint32_t levels = 0;  // of the forest
  std::uint64_t dependencies = 0;
};

Counts count_all(const Hierarchy& hierarchy) {
  hierarchy.require_all();
  Counts counts;
  std::vector<std::uint32_t> depth(hierarchy.split_count());
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    const SplitId parent = hierarchy.node(s).parent;
    depth[s] = parent == no_id ? 1 : depth[parent] + 1;
    counts.levels = std::max(counts.levels, depth[s]);
    counts.dependencies += hierarchy.star(s).dependencies().size();
  }
  return counts;
}

void run(const Options& options) {
  const OlodFile file = read_olod(options.file);
  const Hierarchy& hierarchy = file.hierarchy;
  Json result = {{"file", options.file}, {"format", olod_version}};
  result.update(counts_of(hierarchy));
  result["compressed"] = file.compression != OlodCompression::none;
  result["file_bytes"] = std::filesystem::file_size(options.file);
  result["normals"] = !hierarchy.data().normals.empty();
  result["colors"] = !hierarchy.data().colors.empty();
  result["box"] = {{"min", to_json(glm::dvec3(hierarchy.box().min))},
                   {"max", to_json(glm::dvec3(hierarchy.box().max))}};
  if (options.check) {
    const Counts counts = count_all(hierarchy);
    result["dependencies"] = counts.dependencies;
    result["levels"] = counts.levels;
  }
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
  command.add_flag("--check", options->check, "Read and check the whole file; count dependencies and levels too");
  command.add_flag("--json", options->json, "Print one JSON object");
  command.callback([options] { run(*options); });
}

}  // namespace occlod::tool
