// Implements `occlod cut FILE.olod (--triangles N | --error E) -o MESH`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstddef>
#include <glm/geometric.hpp>
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
#include "number_with_unit.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/mesh_file.h"
#include "option_values.h"
#include "progress.h"
#include "standard_streams.h"

namespace occlod::tool {
namespace {

struct Options {
  std::string file;
  std::string output;
  std::optional<std::size_t> triangles;
  std::optional<Length> error;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

FixedCut chosen_cut(const Options& options, const Hierarchy& hierarchy) {
  if (options.error) {
    const Box& box = hierarchy.box();
    const double diagonal = glm::distance(glm::dvec3(box.min), glm::dvec3(box.max));
    return cut_to_error(hierarchy, in_mesh_units(*options.error, options.file, diagonal));
  }
  const FixedCut cut = cut_to_triangles(hierarchy, *options.triangles);
  if (cut.triangles > *options.triangles)
    throw Error({options.file, "",
                 fmt::format("has no cut of {} triangles: its base mesh has {}", *options.triangles, cut.triangles),
                 "ask for more, or build with a smaller --base-triangles"});
  return cut;
}

void add_files(const Options& options, CommandFiles& files) {
  files.add_input("the hierarchy to read", options.file);
  files.add_mesh_output("--output", options.output);
}

void run(const Options& options) {
  handle_interrupts("cut");
  CommandFiles files;
  add_files(options, files);
  Progress progress(options.progress);
  progress.show("reading " + options.file, std::nullopt);
  const OlodFile file = read_olod(options.file);
  const Hierarchy& hierarchy = file.hierarchy;
  const FixedCut cut = chosen_cut(options, hierarchy);
  const TriangleMesh mesh = cut_mesh(hierarchy, cut);
  std::vector<std::string> notes;
  write_interruptibly(options.output, 0, progress,
                      [&] { notes = write_mesh(options.output, mesh, folder_of(options.file)); });
  progress.clear();
  for (const std::string& note : notes) print_note(note);
  note_lost_origin(options.output, mesh.origin);
  Json result = {{"input", options.file},
                 {"file", options.output},
                 {"vertices", mesh.vertex_count()},
                 {"triangles", mesh.triangle_count()},
                 {"full_triangles", hierarchy.input_triangle_count()},
                 {"splits", cut.splits},
                 {"guaranteed_error", cut.guaranteed_error},
                 {"rms_error", cut.error}};
  add_origin(result, mesh.origin);
  print_result(result, file.report.left_out, options.json);
}

}  // namespace

void add_cut(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("cut", "Extract a coarser mesh from a hierarchy, the same for every view");
  const auto options = std::make_shared<Options>();
  add_file(command, "FILE", options->file, "Hierarchy to read, an .olod file")->required();
  CLI::Option* triangles = add_number(command, "--triangles", options->triangles, WholeRange{1, max_elements},
                                      "At most so many triangles, with the smallest quadric error");
  add_error(command, options->error, Zero::taken,
            "Instead: as few triangles as possible within this guaranteed distance to the full mesh: in the mesh's "
            "unit, such as 0.5, or in % of the diagonal of its bounding box")
      ->excludes(triangles);
  add_file(command, "-o,--output", options->output, "Mesh to write: .ply, .obj, .glb, .off or .stl")->required();
  command.callback([options, &command] {
    read_global_options(command, {.json = &options->json, .progress = &options->progress});
    if (!options->triangles && !options->error) throw CLI::RequiredError("--triangles or --error");
    run(*options);
  });
}

}  // namespace occlod::tool
