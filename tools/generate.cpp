// Implements `occlod generate KIND [NAME=VALUE ...] -o FILE`.
#include "occlod/generate.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstddef>
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
#include "mesh/generators.h"
#include "number_with_unit.h"
#include "occlod/mesh_file.h"
#include "option_values.h"
#include "peak_bytes.h"
#include "progress.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

struct Request {
  std::string kind;
  std::vector<std::string> settings;  // "name=value"
  std::string file;
  bool stream = false;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

// Of a radius or the like, a percentage is as good.
void replace_percents(std::string& text, const GeneratorParameter& parameter) {
  if (parameter.whole || parameter.max > 1.0 || !text.ends_with('%')) return;
  if (const auto ratio = ratio_of(text)) text = fmt::format("{}", *ratio);
}

// Text that in_range() takes is what GeneratorParameter::accepts().
double read_value(std::string text, const GeneratorParameter& parameter) {
  const CLI::Validator check =
      parameter.whole
          ? in_range(WholeRange{static_cast<std::uint64_t>(parameter.min), static_cast<std::uint64_t>(parameter.max)})
          : in_range(RealRange{parameter.min, parameter.max});
  replace_percents(text, parameter);
  if (const std::string wrong = check(text); !wrong.empty())
    throw CLI::ValidationError(std::string(parameter.name), wrong);
  return std::stod(text);
}

GeneratorValues read_values(const Generator& generator, const std::vector<std::string>& settings) {
  GeneratorValues values;
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    const std::string name = setting.substr(0, equals);
    const GeneratorParameter* const parameter = find_named(generator.parameters, name);
    if (parameter == nullptr)
      throw CLI::ValidationError(fmt::format("{} of {} is not one of {}, each followed by =VALUE", shown(name),
                                             generator.name, names_of(generator.parameters)));
    const double value = read_value(equals == std::string::npos ? "" : setting.substr(equals + 1), *parameter);
    if (!values.emplace(name, value).second) throw CLI::ValidationError(name + " is given more than once");
  }
  return values;
}

Json write_whole(const GeneratorValues& values, const Request& request, Progress& progress) {
  progress.show("generating " + request.file, std::nullopt);
  const Stopwatch stopwatch;
  const TriangleMesh mesh = generate(request.kind, values);
  const double generate_ms = stopwatch.milliseconds();
  write_interruptibly(request.file, 0, progress, [&] { write_mesh(request.file, mesh); });
  return {{"vertices", mesh.vertex_count()}, {"triangles", mesh.triangle_count()}, {"generate_ms", generate_ms}};
}

Json write_streamed(const GeneratorValues& values, const Request& request, Progress& progress) {
  check_mesh_parts_output(request.file);
  const Stopwatch stopwatch;
  WrittenCounts counts;
  write_interruptibly(request.file, 0, progress, [&] {
    counts = write_mesh_parts(request.file, [&](const PartVisitor& visit) {
      stream_generated(request.kind, values, [&](const TriangleMesh& part, std::size_t repeated) {
        note_interrupts();  // also while parts are only counted
        visit(part, repeated);
      });
    });
  });
  return {{"vertices", counts.vertices}, {"triangles", counts.triangles}, {"write_ms", stopwatch.milliseconds()}};
}

void run(const Request& request) {
  const GeneratorValues values = read_values(generator_of(request.kind), request.settings);
  handle_interrupts("generate");
  CommandFiles files;
  files.add_mesh_output("--output", request.file);
  Progress progress(request.progress);
  Json result = {{"generator", request.kind}, {"file", request.file}};
  result.update(request.stream ? write_streamed(values, request, progress) : write_whole(values, request, progress));
  result["peak_bytes"] = peak_bytes();
  progress.clear();
  request.json ? print_json(result) : print_lines(result);
}

std::vector<std::string> kinds() {
  std::vector<std::string> names;
  for (const Generator& generator : generators()) names.emplace_back(generator.name);
  return names;
}

// Lists the options in lines like "  level=8             subdivisions, 0 to 11".
std::string table_of_options() {
  std::string text = "Kinds, and their options as they are when not given:\n";
  for (const Generator& generator : generators()) {
    text += fmt::format("  {}: {}\n", generator.name, generator.about);
    for (const GeneratorParameter& parameter : generator.parameters)
      text += fmt::format("    {:<20} {}, {} to {}\n", fmt::format("{}={}", parameter.name, parameter.default_value),
                          parameter.about, parameter.min, parameter.max);
  }
  return text + "For example:\n  occlod generate city blocks=4 -o city.ply";
}

}  // namespace

void add_generate(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("generate", "Generate a test mesh");
  const auto request = std::make_shared<Request>();
  command.add_option("KIND", request->kind, "What to generate, see below")
      ->transform(one_of(kinds()))
      ->required()
      ->type_name("");
  command.add_option("NAME=VALUE", request->settings, "Options of this kind, see below")->type_name("");
  add_file(command, "-o,--output", request->file, "Mesh to write: .ply, .obj, .glb, .off or .stl")->required();
  command.add_flag("--stream", request->stream,
                   "Write the same .ply or .obj piece by piece: slower, and for meshes larger than memory");
  command.footer(table_of_options());
  command.callback([request, &command] {
    read_global_options(command, {.json = &request->json, .progress = &request->progress});
    run(*request);
  });
}

}  // namespace occlod::tool
