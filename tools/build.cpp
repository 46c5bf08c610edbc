// Implements `occlod build MESH -o FILE.olod`.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command_files.h"
#include "commands.h"
#include "global_options.h"
#include "interrupt.h"
#include "json_output.h"
#include "mesh/image_files.h"
#include "mesh/mesh_report.h"
#include "occlod/build_hierarchy.h"
#include "occlod/mesh.h"
#include "occlod/mesh_file.h"
#include "option_values.h"
#include "peak_bytes.h"
#include "progress.h"
#include "repair_advice.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

// Collapses take about this share of a build. They report progress; the steps after them do not.
constexpr double collapse_share = 0.6;

constexpr double largest_boundary_weight = 1e6, largest_attribute_weight = 1e6;

struct Options {
  std::string input;
  std::string output;
  BuildOptions build;
  std::optional<double> crease;  // degrees
  OlodCompression compression = OlodCompression::none;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

CleanMesh read(const Options& options, Progress& progress) {
  const auto show = [&](double done) {
    if (done < 1.0)
      progress.show("reading " + options.input, done);
    else
      progress.show("cleaning " + options.input, std::nullopt);
  };
  CleanMesh mesh = read_mesh(options.input, show, options.build.threads);
  leave_out_features(mesh);
  return mesh;
}

// Makes normals if the file has none. Returns whether it did.
bool crease(const Options& options, CleanMesh& input) {
  if (!options.crease || !input.mesh.normals.empty()) return false;
  input.mesh = crease_normals(input.mesh, *options.crease);
  std::vector<VertexId> seams = input.mesh.extra_wedges;
  input.report.seam_vertices = static_cast<std::uint64_t>(std::unique(seams.begin(), seams.end()) - seams.begin());
  return true;
}

Hierarchy build(const Options& options, const TriangleMesh& mesh, Progress& progress) {
  const std::string what = "building " + options.output;
  progress.show(what, 0.0);
  BuildOptions build = options.build;
  build.progress = [&](double done) {
    progress.show(what, collapse_share * done, mesh.triangle_count());
    return true;
  };
  return build_hierarchy(mesh, build);
}

void add_files(const Options& options, CommandFiles& files) {
  files.add_input("the mesh to read", options.input);
  files.add_output("--output", options.output, ".olod");
}

void run(const Options& options) {
  handle_interrupts("build");
  CommandFiles files;
  add_files(options, files);
  Progress progress(options.progress);
  Stopwatch stopwatch;
  CleanMesh input = read(options, progress);
  const bool creased = crease(options, input);
  const double read_ms = stopwatch.restart();
  const Hierarchy hierarchy = build(options, input.mesh, progress);
  const double build_ms = stopwatch.restart();
  write_interruptibly(options.output, hierarchy.bytes(), progress, [&] {
    write_olod(options.output, hierarchy, input.report, options.compression, folder_of(options.input));
  });
  const double write_ms = stopwatch.milliseconds();
  progress.clear();

  Json result = {{"input", options.input}, {"file", options.output}};
  result.update(counts_of(hierarchy));
  if (options.crease) result["creased"] = creased;
  result["read_ms"] = read_ms;
  result["build_ms"] = build_ms;
  result["write_ms"] = write_ms;
  result["triangles_per_s"] = 1e3 * static_cast<double>(input.mesh.triangle_count()) / build_ms;
  result["peak_bytes"] = peak_bytes();
  if (const auto advice = repair_advice(input.report)) result["advice"] = *advice;
  result["report"] = to_json(input.report);
  if (options.json) return print_json(result);
  print_lines(result);
  print_lines(input.report);
}

}  // namespace

void add_build(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("build", "Build the level-of-detail hierarchy of a mesh");
  const auto options = std::make_shared<Options>();
  add_file(command, "MESH", options->input, "Mesh to read: .ply, .obj, .off, .stl, .gltf or .glb")->required();
  add_file(command, "-o,--output", options->output, "Hierarchy to write, an .olod file")->required();
  add_number(command, "--base-triangles", options->build.base_triangles, WholeRange{0, max_elements},
             "Collapse edges until no more triangles than this are left: the base mesh, and the smallest budget")
      ->capture_default_str();
  add_number(command, "--boundary-weight", options->build.boundary_weight, RealRange{0.0, largest_boundary_weight},
             "Weight of the error at boundary edges, relative to the error of the surface")
      ->capture_default_str();
  add_number(command, "--attribute-weight", options->build.attribute_weight, RealRange{0.0, largest_attribute_weight},
             "Weight of how far texture coordinates, hard normals and colours slip, relative to distances")
      ->capture_default_str();
  add_number(command, "--crease", options->crease, RealRange{0.0, 180.0},
             "Where the file has no normals, make some: smooth where triangles meet at no more than this angle, in "
             "degrees, hard elsewhere");
  add_choice(command, "--error-bound", options->build.error_bound,
             {{"accumulated", ErrorBound::accumulated}, {"measured", ErrorBound::measured}},
             "Guaranteed errors: accumulated (fast to build, loose) or measured (tight, several times the build time)");
  add_choice(command, "--compress", options->compression,
             {{"none", OlodCompression::none}, {"zstd", OlodCompression::zstd}},
             "none: the file is mapped into memory when used; zstd: smaller, but unpacked when used");
  command.callback([options, &command] {
    read_global_options(command,
                        {.json = &options->json, .progress = &options->progress, .threads = &options->build.threads});
    run(*options);
  });
}

}  // namespace occlod::tool
