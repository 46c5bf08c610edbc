// occlod build MESH -o FILE.olod
#include "occlod/hierarchy/build.h"

#include <sys/resource.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "commands.h"
#include "json_output.h"
#include "occlod/io/olod.h"
#include "occlod/io/read_mesh.h"
#include "progress.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

struct Options {
  std::string input;
  std::string output;
  BuildOptions build;
  OlodCompression compression = OlodCompression::none;
  bool json = false;
};

// The most memory that this process has held.
std::uint64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts KiB
}

Hierarchy build_with_progress(const Options& options, const TriangleMesh& mesh) {
  Progress progress;
  BuildOptions build = options.build;
  build.progress = [&](double done) {
    progress.show(options.input, done);
    return true;
  };
  return build_hierarchy(mesh, build);
}

void run(const Options& options) {
  const CleanMesh input = read_mesh(options.input);
  const Stopwatch stopwatch;
  const Hierarchy hierarchy = build_with_progress(options, input.mesh);
  const double build_ms = stopwatch.milliseconds();
  write_olod(options.output, hierarchy, input.report, options.compression);

  Json result = {{"input", options.input}, {"file", options.output}};
  result.update(counts_of(hierarchy));
  result["build_ms"] = build_ms;
  result["peak_bytes"] = peak_bytes();
  result["report"] = to_json(input.report);
  if (options.json) return print_json(result);
  print_lines(result);
  print_lines(result["report"]);
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
  command.add_option("--threads", options->build.threads, "Threads; 0 = one for each core. The result is the same")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  command
      .add_option("--compress", options->compression,
                  "none: the file is mapped when used; zstd: smaller, unpacked into memory when used")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, OlodCompression>{{"none", OlodCompression::none}, {"zstd", OlodCompression::zstd}}))
      ->default_str("none");
  command.add_flag("--json", options->json, "Print one JSON object");
  command.callback([options] { run(*options); });
}

}  // namespace occlod::tool
