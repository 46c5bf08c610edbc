// Implements `occlod info FILE`.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "global_options.h"
#include "json_output.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/mesh_file.h"
#include "option_values.h"
#include "repair_advice.h"
#include "splits/star.h"

namespace occlod::tool {
namespace {

struct Options {
  std::string file;
  bool all = false;
  bool json = false;
};

// Holds what requires a look at every split.
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
    counts.dependencies += star_of(hierarchy, s).dependencies().size();
  }
  return counts;
}

// `reported` tells what was found when the mesh was read.
void print(const Options& options, Json result, const MeshReport& reported) {
  if (const auto advice = repair_advice(reported)) result["advice"] = *advice;
  result["report"] = to_json(reported);
  if (options.json) return print_json(result);
  print_lines(result);
  print_lines(reported);
}

void tell_mesh(const Options& options) {
  const CleanMesh file = read_mesh(options.file);
  Json result = {{"file", options.file},
                 {"vertices", file.mesh.vertex_count()},
                 {"wedges", file.mesh.wedge_count()},
                 {"triangles", file.mesh.triangle_count()},
                 {"normals", !file.mesh.normals.empty()},
                 {"colors", !file.mesh.colors.empty()},
                 {"texture_coordinates", !file.mesh.texture_coordinates.empty()},
                 {"materials", file.mesh.materials.size()},
                 {"textures", file.mesh.textures.size()},
                 {"features", file.mesh.feature_names.size()},
                 {"box", to_json(bounding_box(file.mesh.positions), file.mesh.origin)}};
  add_origin(result, file.mesh.origin);
  print(options, std::move(result), file.report);
}

void tell_hierarchy(const Options& options) {
  const OlodFile file = read_olod(options.file);
  const Hierarchy& hierarchy = file.hierarchy;
  Json result = {{"file", options.file}, {"format", file.version}};
  result.update(counts_of(hierarchy));
  result["compressed"] = file.compression != OlodCompression::none;
  result["file_bytes"] = std::filesystem::file_size(options.file);
  result["normals"] = !hierarchy.data().normals.empty();
  result["colors"] = !hierarchy.data().colors.empty();
  result["box"] = to_json(hierarchy.box(), hierarchy.data().origin);
  if (options.all) {
    const Counts counts = count_all(hierarchy);
    result["dependencies"] = counts.dependencies;
    result["levels"] = counts.levels;
  }
  print(options, std::move(result), file.report);
}

void refuse_others(const std::string& file) {
  const std::filesystem::path extension = std::filesystem::path(file).extension();
  if (extension == ".ohlod") throw Error({file, "", "is an .ohlod file", "use 'occlod hlod info'"});
  if (extension == ".vlod") throw Error({file, "", "is a .vlod file", "use 'occlod cells info'"});
}

bool is_hierarchy(const std::string& file) { return std::filesystem::path(file).extension() == ".olod"; }

}  // namespace

void add_info(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("info", "Describe a hierarchy or a mesh");
  const auto options = std::make_shared<Options>();
  add_file(command, "FILE", options->file, "An .olod file or a mesh")->required();
  command.add_flag(
      "--all", options->all,
      "Read and check all of an .olod file, and count dependencies and levels; meshes are read in full anyway");
  command.callback([options, &command] {
    read_global_options(command, {.json = &options->json});
    refuse_others(options->file);
    is_hierarchy(options->file) ? tell_hierarchy(*options) : tell_mesh(*options);
  });
}

}  // namespace occlod::tool
