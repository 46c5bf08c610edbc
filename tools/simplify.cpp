// Implements `occlod simplify MESH (--ratio R | --triangles N) -o MESH`.
#include "occlod/simplify.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
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
  std::string input;
  std::string output;
  std::optional<std::size_t> triangles;
  std::optional<double> ratio;
  SimplifyOptions simplify;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

// Takes "10%" and "0.1"; returns nothing for other text and for what is not above 0 and at most 1.
std::optional<double> ratio_of(std::string text) {
  const bool percent = text.ends_with('%');
  if (percent) text.pop_back();
  double value = 0.0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (percent) value /= 100.0;
  if (!(value > 0.0 && value <= 1.0)) return std::nullopt;
  return value;
}

std::size_t wanted_triangles(const Options& options, std::size_t full) {
  if (options.triangles) return *options.triangles;
  return std::max<std::size_t>(1, static_cast<std::size_t>(*options.ratio * static_cast<double>(full)));
}

CleanMesh read(const Options& options, Progress& progress) {
  const auto show = [&](double done) {
    if (done < 1.0)
      progress.show("reading " + options.input, done);
    else
      progress.show("cleaning " + options.input, std::nullopt);
  };
  return read_mesh(options.input, show, options.simplify.threads);
}

TriangleMesh reduce(const Options& options, const TriangleMesh& mesh, Progress& progress) {
  SimplifyOptions simplify_options = options.simplify;
  simplify_options.progress = [&](double done) {
    progress.show("simplifying " + options.input, done, mesh.triangle_count());
    return true;
  };
  return simplify(mesh, wanted_triangles(options, mesh.triangle_count()), simplify_options);
}

void run(const Options& options) {
  handle_interrupts("simplify");
  CommandFiles files;
  files.add_input("the mesh to read", options.input);
  files.add_mesh_output("--output", options.output);
  Progress progress(options.progress);
  Stopwatch stopwatch;
  const CleanMesh input = read(options, progress);
  const double read_ms = stopwatch.restart();
  const TriangleMesh mesh = reduce(options, input.mesh, progress);
  const double simplify_ms = stopwatch.restart();
  std::vector<std::string> notes;
  write_interruptibly(options.output, 0, progress,
                      [&] { notes = write_mesh(options.output, mesh, folder_of(options.input)); });
  progress.clear();
  for (const std::string& note : notes) print_note(note);
  note_lost_origin(options.output, mesh.origin);
  Json result = {{"input", options.input},
                 {"file", options.output},
                 {"full_triangles", input.mesh.triangle_count()},
                 {"triangles", mesh.triangle_count()},
                 {"vertices", mesh.vertex_count()},
                 {"read_ms", read_ms},
                 {"simplify_ms", simplify_ms},
                 {"write_ms", stopwatch.milliseconds()},
                 {"peak_bytes", peak_bytes()}};
  add_origin(result, mesh.origin);
  result["report"] = to_json(input.report);
  if (options.json) return print_json(result);
  result.erase("report");
  print_lines(result);
  print_lines(input.report);
}

}  // namespace

void add_simplify(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("simplify", "Reduce a mesh to fewer triangles, the same for every view");
  const auto options = std::make_shared<Options>();
  add_file(command, "MESH", options->input, "Mesh to read: .ply, .obj, .off, .stl, .gltf or .glb")->required();
  add_file(command, "-o,--output", options->output, "Mesh to write: .ply, .obj, .glb, .off or .stl")->required();
  CLI::Option* triangles =
      add_number(command, "--triangles", options->triangles, WholeRange{1, max_elements}, "At most so many triangles");
  const auto check_ratio = CLI::Validator(
      [](std::string& text) {
        return ratio_of(text) ? std::string()
                              : fmt::format("{} is not a share above 0 and at most 1, such as 10% or 0.1", shown(text));
      },
      "", "ratio");
  command
      .add_option_function<std::string>(
          "--ratio", [options](const std::string& text) { options->ratio = ratio_of(text); },
          "Instead: at most this share of the mesh's triangles, such as 10% or 0.1")
      ->transform(check_ratio)
      ->type_name("R")
      ->excludes(triangles);
  command.callback([options, &command] {
    read_global_options(
        command, {.json = &options->json, .progress = &options->progress, .threads = &options->simplify.threads});
    if (!options->triangles && !options->ratio) throw CLI::RequiredError("--ratio or --triangles");
    run(*options);
  });
}

}  // namespace occlod::tool
