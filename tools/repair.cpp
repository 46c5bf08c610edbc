// Implements `occlod repair MESH -o OUT`.
#include "repair/repair.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstddef>
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
#include "occlod/base.h"
#include "occlod/mesh.h"
#include "occlod/mesh_file.h"
#include "option_values.h"
#include "progress.h"
#include "standard_streams.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

using repair::RepairCounts;
using repair::RepairedMesh;

struct Options {
  std::string input;
  std::string output;
  repair::RepairOptions repair;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

CleanMesh read(const Options& options, Progress& progress) {
  CleanMesh mesh = read_mesh(options.input, [&](double done) { progress.show("reading " + options.input, done); });
  leave_out_features(mesh);
  return mesh;
}

RepairedMesh repair_input(const Options& options, const TriangleMesh& mesh, Progress& progress) {
  repair::RepairOptions with_progress = options.repair;
  with_progress.progress = [&](const std::string& what, std::optional<double> done) { progress.show(what, done); };
  RepairedMesh repaired = repair::repair_mesh(mesh, with_progress);
  if (repaired.mesh.triangles.empty())
    throw Error({options.input, "", fmt::format("nothing is left of {} triangles", mesh.triangle_count()),
                 "give a mesh with a triangle that has an area, or a smaller --weld"});
  return repaired;
}

Json to_json(const RepairCounts& counts) {
  return {{"vertices_welded", counts.vertices_welded},
          {"collapsed_triangles_dropped", counts.collapsed_dropped},
          {"repeated_triangles_dropped", counts.repeated_dropped},
          {"opposite_triangles_dropped", counts.opposite_dropped},
          {"zero_area_triangles_dropped", counts.zero_area_dropped},
          {"zero_area_triangles_flipped", counts.zero_area_flipped},
          {"zero_area_triangles_kept", counts.zero_area_kept},
          {"triangles_turned", counts.triangles_turned},
          {"unorientable_edges", counts.unorientable_edges},
          {"vertices_duplicated", counts.vertices_duplicated},
          {"edges_stitched", counts.edges_stitched},
          {"holes_filled", counts.holes_filled},
          {"triangles_added", counts.triangles_added},
          {"borders_left", counts.borders_left}};
}

Json topology_of(const TriangleMesh& mesh, const MeshReport& report) {
  Json topology = {{"vertices", mesh.vertex_count()}, {"triangles", mesh.triangle_count()}};
  topology.update(topology_to_json(report));
  return topology;
}

// `after` counts vertices at one place as different, as in the file. `after_welding` is what a reader that welds gets.
Json report_of(const Options& options, const CleanMesh& input, const RepairedMesh& repaired) {
  MeshReport after;
  count_topology(repaired.mesh, after);
  const CleanMesh welded = clean(repaired.mesh, {}, options.output);
  Json report = {{"input", options.input}, {"file", options.output}};
  add_origin(report, repaired.mesh.origin);
  report["orientable"] = repaired.changes.unorientable_edges == 0;
  report["changes"] = to_json(repaired.changes);
  report["before"] = topology_of(input.mesh, input.report);
  report["after"] = topology_of(repaired.mesh, after);
  report["after_welding"] = topology_of(welded.mesh, welded.report);
  report["report"] = tool::to_json(input.report);
  return report;
}

void print_topology(const Json& report) {
  const char* const row = "{:<22} {:>12} {:>12} {:>12}\n";
  fmt::print(fmt::runtime(row), "", "before", "after", "welded again");
  for (const auto& [key, before] : report["before"].items())
    fmt::print(fmt::runtime(row), key, before.dump(), report["after"][key].dump(), report["after_welding"][key].dump());
}

void print_report(Json report, const LeftOut& left_out, const RepairCounts& changes) {
  report["left_out"] = in_words(left_out);
  print_lines(report);
  print_lines(report["changes"]);
  print_topology(report);
  if (changes.unorientable_edges > 0)
    fmt::print("{}: cannot be oriented, it has one side only, as a Moebius band has: cut along {} edges\n",
               printable(report["input"].get<std::string>()), changes.unorientable_edges);
}

void add_files(const Options& options, CommandFiles& files) {
  files.add_input("the mesh to read", options.input);
  files.add_mesh_output("--output", options.output);
}

void run(const Options& options) {
  handle_interrupts("repair");
  CommandFiles files;
  add_files(options, files);
  Progress progress(options.progress);
  const CleanMesh input = read(options, progress);
  const Stopwatch stopwatch;
  const RepairedMesh repaired = repair_input(options, input.mesh, progress);
  const double repair_ms = stopwatch.milliseconds();
  std::vector<std::string> notes;
  write_interruptibly(options.output, 0, progress,
                      [&] { notes = write_mesh(options.output, repaired.mesh, folder_of(options.input)); });
  progress.clear();
  note_lost_origin(options.output, repaired.mesh.origin);
  for (const std::string& note : notes) print_note(note);
  Json report = report_of(options, input, repaired);
  report["repair_ms"] = repair_ms;
  options.json ? print_json(report) : print_report(report, input.report.left_out, repaired.changes);
}

}  // namespace

void add_repair(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("repair", "Turn a mesh into an oriented manifold, and count every change");
  command.footer(
      "Reading a mesh welds vertices with exactly the same position. Non-manifold edges and vertices are\n"
      "taken apart by duplicating vertices; a program that welds, as occlod does, joins them again.\n"
      "A program with this command contains parts of CGAL under the GPL.");
  const auto options = std::make_shared<Options>();
  add_file(command, "MESH", options->input, "Mesh to read: .ply, .obj, .off, .stl, .gltf or .glb")->required();
  add_file(command, "-o,--output", options->output, "Mesh to write: .ply, .obj, .glb, .off or .stl")->required();
  add_number(command, "--weld", options->repair.weld, RealRange{},
             "Also merge vertices that are no farther apart than this, object units")
      ->capture_default_str();
  add_number(command, "--fill-holes", options->repair.fill_holes, WholeRange{0, max_elements},
             "Close holes with at most so many edges; 0: none")
      ->capture_default_str();
  command.callback([options, &command] {
    read_global_options(command, {.json = &options->json, .progress = &options->progress});
    run(*options);
  });
}

}  // namespace occlod::tool
