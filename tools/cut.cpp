// occlod cut FILE.olod (--triangles N | --error E) -o MESH
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "commands.h"
#include "interrupt.h"
#include "json_output.h"
#include "occlod/core/error.h"
#include "occlod/hierarchy/cut_mesh.h"
#include "occlod/io/olod.h"
#include "occlod/io/write_mesh.h"
#include "progress.h"

namespace occlod::tool {
namespace {

struct Options {
  std::string file;
  std::string output;
  std::optional<std::size_t> triangles;
  std::optional<double> error;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

FixedCut chosen_cut(const Options& options, const Hierarchy& hierarchy) {
  if (options.error) return cut_to_error(hierarchy, *options.error);
  const FixedCut cut = cut_to_triangles(hierarchy, *options.triangles);
  if (cut.triangles > *options.triangles)
    throw Error({options.file, "",
                 fmt::format("has no cut of {} triangles: its base mesh has {}", *options.triangles, cut.triangles),
                 "ask for more, or build with a smaller --base-triangles"});
  return cut;
}

void run(const Options& options) {
  handle_interrupts("cut");
  Progress progress(options.progress);
  progress.show("reading " + options.file, std::nullopt);
  const Hierarchy hierarchy = read_olod(options.file).hierarchy;
  const FixedCut cut = chosen_cut(options, hierarchy);
  const TriangleMesh mesh = cut_mesh(hierarchy, cut);
  write_interruptibly(options.output, 0, progress, [&] { write_mesh(options.output, mesh); });
  progress.clear();
  const Json result = {{"input", options.file},
                       {"file", options.output},
                       {"vertices", mesh.vertex_count()},
                       {"triangles", mesh.triangle_count()},
                       {"full_triangles", hierarchy.input_triangle_count()},
                       {"splits", cut.splits},
                       {"guaranteed_error", cut.guaranteed_error},
                       {"rms_error", cut.error}};
  options.json ? print_json(result) : print_lines(result);
}

}  // namespace

void add_cut(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("cut", "Write a coarser mesh out of a hierarchy, the same from every side");
  const auto options = std::make_shared<Options>();
  command.add_option("FILE", options->file, "An .olod file")->required();
  CLI::Option_group& size = *command.add_option_group("size", "How fine; exactly one of");
  size.add_option("--triangles", options->triangles, "At most so many triangles: the splits of the dearest collapses")
      ->check(CLI::PositiveNumber);
  size.add_option_function<double>(
      "--error",
      [options](double error) {
        if (!std::isfinite(error) || error < 0.0) throw CLI::ValidationError("--error", "is not a length");
        options->error = error;
      },
      "As few triangles as a guaranteed distance to the full mesh allows, object units");
  size.require_option(1);
  command.add_option("-o,--output", options->output, "Mesh to write: .ply, .obj, .off or .stl")->required();
  add_progress_option(command, options->progress);
  command.add_flag("--json", options->json, "Print one JSON object");
  command.callback([options] { run(*options); });
}

}  // namespace occlod::tool
