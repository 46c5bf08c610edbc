// occlod build MESH -o FILE.olod
#include "occlod/hierarchy/build.h"

#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "commands.h"
#include "interrupt.h"
#include "json_output.h"
#include "occlod/io/olod.h"
#include "occlod/io/read_mesh.h"
#include "progress.h"
#include "repair_advice.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

// Of the time of a build, roughly: collapses report how far they are, what is made of them afterwards does not.
constexpr double collapse_share = 0.6;

struct Options {
  std::string input;
  std::string output;
  BuildOptions build;
  OlodCompression compression = OlodCompression::none;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

// The most memory that this process has held.
std::uint64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts KiB
}

CleanMesh read(const Options& options, Progress& progress) {
  return read_mesh(options.input, [&](double done) {
    if (done < 1.0)
      progress.show("reading " + options.input, done);
    else
      progress.show("cleaning " + options.input, std::nullopt);
  });
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

void run(const Options& options) {
  handle_interrupts("build");
  Progress progress(options.progress);
  Stopwatch stopwatch;
  const CleanMesh input = read(options, progress);
  const double read_ms = stopwatch.restart();
  const Hierarchy hierarchy = build(options, input.mesh, progress);
  const double build_ms = stopwatch.restart();
  write_interruptibly(options.output, hierarchy.bytes(), progress,
                      [&] { write_olod(options.output, hierarchy, input.report, options.compression); });
  const double write_ms = stopwatch.milliseconds();
  progress.clear();

  Json result = {{"input", options.input}, {"file", options.output}};
  result.update(counts_of(hierarchy));
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
  CLI::App& command = *app.add_subcommand("build", "Build the hierarchy of a mesh");
  const auto options = std::make_shared<Options>();
  command.add_option("MESH", options->input, "Mesh to read: .ply, .obj, .off, .stl, .gltf or .glb")->required();
  command.add_option("-o,--output", options->output, "Hierarchy to write, an .olod file")->required();
  command.add_option("--base-triangles", options->build.base_triangles, "Stop collapsing at so many triangles")
      ->capture_default_str();
  command
      .add_option("--boundary-weight", options->build.boundary_weight,
                  "How firmly boundaries are held, relative to the surface")
      ->capture_default_str();
  command
      .add_option("--error-bound", options->build.error_bound,
                  "Guaranteed errors: accumulated (quick) or measured (tight, several times the building time)")
      ->transform(CLI::CheckedTransformer(std::map<std::string, ErrorBound>{{"measured", ErrorBound::measured},
                                                                            {"accumulated", ErrorBound::accumulated}}))
      ->default_str("accumulated");
  command.add_option("--threads", options->build.threads, "Threads; 0 = one for each core. The result is the same")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  command
      .add_option("--compress", options->compression,
                  "none: the file is mapped when used; zstd: smaller, unpacked into memory when used")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, OlodCompression>{{"none", OlodCompression::none}, {"zstd", OlodCompression::zstd}}))
      ->default_str("none");
  add_progress_option(command, options->progress);
  command.add_flag("--json", options->json, "Print one JSON object");
  command.callback([options] { run(*options); });
}

}  // namespace occlod::tool
