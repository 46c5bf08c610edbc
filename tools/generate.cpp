// Implements `occlod generate KIND [NAME=VALUE ...] -o FILE`.
#include "occlod/generate.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
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

// Returns the allowed values of an option as a range of the right type.
template <class Options>
WholeRange range_of(const GeneratorOption<Options, int>& option) {
  return {static_cast<std::uint64_t>(option.low), static_cast<std::uint64_t>(option.high)};
}
template <class Options>
WholeRange range_of(const GeneratorOption<Options, std::uint64_t>&) {
  return {};
}
template <class Options>
RealRange range_of(const GeneratorOption<Options, double>& option) {
  return {option.low, option.high};
}

template <class Options, class Value>
void assign(Value& value, std::string text, const GeneratorOption<Options, Value>& option) {
  if (const std::string wrong = in_range(range_of(option))(text); !wrong.empty())
    throw CLI::ValidationError(option.name, wrong);
  CLI::detail::lexical_cast(text, value);  // it was checked
}

template <class Options>
std::string names_of_options() {
  std::string names;
  const Options options;
  for_each_option(options, [&](const auto& option, const auto&) {
    names += (names.empty() ? "" : ", ") + std::string(option.name);
  });
  return names;
}

template <class Options>
Options read_settings(const std::vector<std::string>& settings) {
  Options options;
  std::vector<std::string> known;
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    const std::string name = setting.substr(0, equals);
    bool is_known = false;
    for_each_option(options, [&](const auto& option, auto& value) {
      if (name != option.name) return;
      is_known = true;
      assign(value, equals == std::string::npos ? "" : setting.substr(equals + 1), option);
    });
    if (!is_known)
      throw CLI::ValidationError(fmt::format("{} of {} is not one of {}, each followed by =VALUE", shown(name),
                                             Generator<Options>::name, names_of_options<Options>()));
    if (std::find(known.begin(), known.end(), name) != known.end())
      throw CLI::ValidationError(name + " is given more than once");
    known.push_back(name);
  }
  return options;
}

template <class Options>
Json write_whole(const Options& options, const Request& request, Progress& progress) {
  progress.show("generating " + request.file, std::nullopt);
  const Stopwatch stopwatch;
  const TriangleMesh mesh = Generator<Options>::generate(options);
  const double generate_ms = stopwatch.milliseconds();
  write_interruptibly(request.file, 0, progress, [&] { write_mesh(request.file, mesh); });
  return {{"vertices", mesh.vertex_count()}, {"triangles", mesh.triangle_count()}, {"generate_ms", generate_ms}};
}

template <class Options>
Json write_streamed(const Options& options, const Request& request, Progress& progress) {
  check_mesh_parts_output(request.file);
  const Stopwatch stopwatch;
  WrittenCounts counts;
  write_interruptibly(request.file, 0, progress, [&] {
    counts = write_mesh_parts(request.file, [&](const PartVisitor& visit) {
      Generator<Options>::stream(options, [&](const TriangleMesh& part, std::size_t repeated) {
        note_interrupts();  // even while parts are only counted
        visit(part, repeated);
      });
    });
  });
  return {{"vertices", counts.vertices}, {"triangles", counts.triangles}, {"write_ms", stopwatch.milliseconds()}};
}

template <class Options>
void run(const Options& options, const Request& request) {
  handle_interrupts("generate");
  CommandFiles().add_mesh_output("--output", request.file);
  Progress progress(request.progress);
  Json result = {{"generator", request.kind}, {"file", request.file}};
  result.update(request.stream ? write_streamed(options, request, progress) : write_whole(options, request, progress));
  result["peak_bytes"] = peak_bytes();
  progress.clear();
  request.json ? print_json(result) : print_lines(result);
}

std::vector<std::string> kinds() {
  std::vector<std::string> names;
  for_each_generator([&]<class Options>(const Options&) { names.emplace_back(Generator<Options>::name); });
  return names;
}

// Lists the options in lines like "  level=8             subdivisions, 0 to 11".
std::string table_of_options() {
  std::string text = "Kinds, and their options as they are when not given:\n";
  for_each_generator([&]<class Options>(const Options& defaults) {
    text += fmt::format("  {}: {}\n", Generator<Options>::name, Generator<Options>::about);
    for_each_option(defaults, [&](const auto& option, const auto& value) {
      const auto range = range_of(option);
      const bool has_limits = option.low < option.high;
      text += fmt::format("    {:<20} {}{}\n", fmt::format("{}={}", option.name, value), option.about,
                          has_limits ? fmt::format(", {} to {}", range.low, range.high) : "");
    });
  });
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
    for_each_generator([&]<class Options>(const Options&) {
      if (request->kind == Generator<Options>::name) run(read_settings<Options>(request->settings), *request);
    });
  });
}

}  // namespace occlod::tool
