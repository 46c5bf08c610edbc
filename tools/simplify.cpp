// Implements `occlod simplify MESH... (--triangles N | --ratio R | --error E) -o MESH`.
#include "occlod/simplify.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "command_files.h"
#include "commands.h"
#include "global_options.h"
#include "interrupt.h"
#include "json_output.h"
#include "mesh/image_files.h"
#include "mesh/mesh_report.h"
#include "number_with_unit.h"
#include "occlod/base.h"
#include "occlod/bounds.h"
#include "occlod/mesh.h"
#include "occlod/mesh_file.h"
#include "option_values.h"
#include "peak_bytes.h"
#include "progress.h"
#include "standard_streams.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

struct Options {
  std::vector<std::string> inputs;
  std::string output;
  std::optional<std::size_t> triangles;
  std::optional<double> ratio;
  std::optional<Length> error;
  SimplifyOptions simplify;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

double diagonal_of(const TriangleMesh& mesh) {
  const Box box = bounding_box(mesh.positions);
  return glm::distance(glm::dvec3(box.min), glm::dvec3(box.max));
}

CleanMesh read(const Options& options, const std::string& file, Progress& progress) {
  const auto show = [&](double done) {
    if (done < 1.0)
      progress.show("reading " + file, done);
    else
      progress.show("cleaning " + file, std::nullopt);
  };
  CleanMesh mesh = read_mesh(file, show, options.simplify.threads);
  leave_out_features(mesh);
  return mesh;
}

SimplifiedMesh reduce(const Options& options, const std::string& file, const TriangleMesh& mesh, Progress& progress) {
  SimplifyOptions simplify_options = options.simplify;
  simplify_options.progress = [&](double done) {
    progress.show("simplifying " + file, done, options.error ? 0 : mesh.triangle_count());
    return true;
  };
  if (options.error)
    return simplify_within(mesh, in_mesh_units(*options.error, file, diagonal_of(mesh)), simplify_options);
  const double share = options.ratio.value_or(0.0) * static_cast<double>(mesh.triangle_count());
  const std::size_t most = options.triangles.value_or(std::max<std::size_t>(4, static_cast<std::size_t>(share)));
  return {simplify(mesh, most, simplify_options), 0.0};
}

Json run_one(const Options& options, const std::string& input_file, const std::string& output_file,
             Progress& progress) {
  Stopwatch stopwatch;
  const CleanMesh input = read(options, input_file, progress);
  const double read_ms = stopwatch.restart();
  const SimplifiedMesh reduced = reduce(options, input_file, input.mesh, progress);
  const TriangleMesh& mesh = reduced.mesh;
  const double simplify_ms = stopwatch.restart();
  std::vector<std::string> notes;
  write_interruptibly(output_file, 0, progress, [&] { notes = write_mesh(output_file, mesh, folder_of(input_file)); });
  progress.clear();
  for (const std::string& note : notes) print_note(note);
  note_lost_origin(output_file, mesh.origin);
  Json result = {{"input", input_file},
                 {"file", output_file},
                 {"full_triangles", input.mesh.triangle_count()},
                 {"triangles", mesh.triangle_count()},
                 {"vertices", mesh.vertex_count()}};
  if (options.error) result["distance"] = reduced.distance;
  result.update({{"read_ms", read_ms},
                 {"simplify_ms", simplify_ms},
                 {"write_ms", stopwatch.milliseconds()},
                 {"peak_bytes", peak_bytes()}});
  add_origin(result, mesh.origin);
  result["report"] = to_json(input.report);
  if (options.json) return result;
  result.erase("report");
  print_lines(result);
  print_lines(input.report);
  return result;
}

// Several meshes keep their names, in a folder.
std::string output_of(const Options& options, const std::string& input) {
  if (options.inputs.size() == 1 && !std::filesystem::is_directory(options.output)) return options.output;
  return (options.output / std::filesystem::path(input).filename()).string();
}

void make_folder(const Options& options) {
  if (options.inputs.size() == 1) return;
  std::error_code problem;
  std::filesystem::create_directories(options.output, problem);
  if (problem || !std::filesystem::is_directory(options.output))
    throw Error({options.output, "", "is no folder, which several meshes need", "name a folder with -o"});
}

// Goes on after a mesh that fails, and fails at the end.
void run(const Options& options) {
  handle_interrupts("simplify");
  make_folder(options);
  CommandFiles files;
  for (const std::string& input : options.inputs) files.add_input("the mesh to read", input);
  for (const std::string& input : options.inputs) files.add_mesh_output("--output", output_of(options, input));
  Progress progress(options.progress);
  Json results = Json::array();
  std::vector<std::string> failures;
  for (const std::string& input : options.inputs) {
    try {
      results.push_back(run_one(options, input, output_of(options, input), progress));
    } catch (const Error& error) {
      if (options.inputs.size() == 1) throw;
      progress.clear();
      print_error(error.what());
      failures.push_back(input);
    }
  }
  if (options.json) print_json(options.inputs.size() == 1 ? results[0] : Json{{"meshes", results}});
  if (!failures.empty())
    throw Error({"simplify", "", fmt::format("{} of {} meshes failed", failures.size(), options.inputs.size()),
                 "see the lines above"});
}

}  // namespace

void add_simplify(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("simplify", "Reduce meshes to fewer triangles, the same for every view");
  const auto options = std::make_shared<Options>();
  command.add_option("MESH", options->inputs, "Meshes to read: .ply, .obj, .off, .stl, .gltf or .glb")
      ->transform(file_name())
      ->type_name("")
      ->required();
  add_file(command, "-o,--output", options->output,
           "Mesh to write: .ply, .obj, .glb, .off or .stl; of several meshes a folder for files of the same names")
      ->required();
  CLI::Option* triangles =
      add_number(command, "--triangles", options->triangles, WholeRange{1, max_elements}, "At most so many triangles");
  CLI::Option* ratio =
      add_ratio(command, options->ratio,
                "Instead: at most this share of the mesh's triangles, such as 10% or 0.1, or 4 triangles")
          ->excludes(triangles);
  add_error(command, options->error, Zero::refused,
            "Instead: as few triangles as leave no point of either surface farther from the other, as measured: in "
            "the mesh's unit, such as 0.5; in mm, cm or m of glTF; or in % of the diagonal of its bounding box")
      ->excludes(triangles)
      ->excludes(ratio);
  command.callback([options, &command] {
    read_global_options(
        command, {.json = &options->json, .progress = &options->progress, .threads = &options->simplify.threads});
    if (!options->triangles && !options->ratio && !options->error)
      throw CLI::RequiredError("--triangles, --ratio or --error");
    run(*options);
  });
}

}  // namespace occlod::tool
