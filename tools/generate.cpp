// occlod generate KIND ... -o FILE
#include "occlod/generate.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "command_files.h"
#include "commands.h"
#include "interrupt.h"
#include "json_output.h"
#include "occlod/mesh_file.h"
#include "option_values.h"
#include "peak_bytes.h"
#include "progress.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

struct Output {
  std::string file;
  bool stream = false;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

// One kind of mesh, as a whole and in parts.
template <class Options>
struct Generator {
  TriangleMesh (*generate)(const Options& options);
  void (*stream)(const Options& options, const PartVisitor& visit);
};

template <class Options>
Json write_whole(const Options& options, const Output& output, const Generator<Options>& generator,
                 Progress& progress) {
  progress.show("generating " + output.file, std::nullopt);
  const Stopwatch stopwatch;
  const TriangleMesh mesh = generator.generate(options);
  const double generate_ms = stopwatch.milliseconds();
  write_interruptibly(output.file, 0, progress, [&] { write_mesh(output.file, mesh); });
  return {{"vertices", mesh.vertex_count()}, {"triangles", mesh.triangle_count()}, {"generate_ms", generate_ms}};
}

template <class Options>
Json write_streamed(const Options& options, const Output& output, const Generator<Options>& generator,
                    Progress& progress) {
  check_mesh_parts_output(output.file);
  const Stopwatch stopwatch;
  WrittenCounts counts;
  write_interruptibly(output.file, 0, progress, [&] {
    counts = write_mesh_parts(output.file, [&](const PartVisitor& visit) {
      generator.stream(options, [&](const TriangleMesh& part, std::size_t repeated) {
        note_interrupts();  // also while parts are only counted
        visit(part, repeated);
      });
    });
  });
  return {{"vertices", counts.vertices}, {"triangles", counts.triangles}, {"write_ms", stopwatch.milliseconds()}};
}

template <class Options>
void run(const std::string& kind, const Options& options, const Output& output, const Generator<Options>& generator) {
  handle_interrupts("generate");
  CommandFiles().add_mesh_output("--output", output.file);
  Progress progress(output.progress);
  Json result = {{"generator", kind}, {"file", output.file}};
  result.update(output.stream ? write_streamed(options, output, generator, progress)
                              : write_whole(options, output, generator, progress));
  result["peak_bytes"] = peak_bytes();
  progress.clear();
  output.json ? print_json(result) : print_lines(result);
}

// One kind of scene; `add_options` adds the options of its own.
template <class Options, class AddOptions>
void add_kind(CLI::App& generate_command, const std::string& kind, const std::string& about,
              const Generator<Options>& generator, const AddOptions& add_options) {
  CLI::App& command = *generate_command.add_subcommand(kind, about);
  const auto options = std::make_shared<Options>();
  const auto output = std::make_shared<Output>();
  add_options(command, *options);
  add_number(command, "--seed", options->seed, WholeRange{}, "Random seed")->capture_default_str();
  add_file(command, "-o,--output", output->file, "Mesh to write: .ply, .obj, .glb, .off or .stl")->required();
  command.add_flag("--stream", output->stream,
                   "Write the same .ply or .obj piece by piece: slower, and for meshes larger than memory");
  add_progress_option(command, output->progress);
  command.add_flag("--json", output->json, "Print the result as one JSON object");
  command.callback([=] { run(kind, *options, *output, generator); });
}

template <class Value, class Range>
void add(CLI::App& kind, const std::string& name, Value& value, Range range, const std::string& about) {
  add_number(kind, name, value, range, about)->capture_default_str();
}

}  // namespace

void add_generate(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("generate", "Generate a test mesh");
  command.require_subcommand(1);
  add_kind<RoughPlanetOptions>(
      command, "rough-planet", "A sphere with random hills: 8 * 4^level triangles",
      {generate_rough_planet, stream_rough_planet}, [](CLI::App& kind, RoughPlanetOptions& options) {
        add(kind, "--level", options.level, WholeRange{0, 11}, "Subdivisions");
        add(kind, "--amplitude", options.amplitude, RealRange{0.0, 0.99}, "Largest height of a hill, of the radius");
        add(kind, "--frequency", options.frequency, RealRange{0.0, 1e6}, "Noise cells per radius");
        add(kind, "--octaves", options.octaves, WholeRange{0, 30}, "Octaves of noise");
      });
  add_kind<CityOptions>(command, "city", "Blocks of buildings on a plane, z up", {generate_city, stream_city},
                        [](CLI::App& kind, CityOptions& options) {
                          add(kind, "--blocks", options.blocks, WholeRange{1, 256}, "Blocks along each side");
                          add(kind, "--facade-cells", options.facade_cells, WholeRange{1, 256},
                              "Cells along each edge of a wall; two triangles per cell");
                        });
  add_kind<PipesOptions>(command, "pipes", "A bundle of bent pipes in a unit cube", {generate_pipes, stream_pipes},
                         [](CLI::App& kind, PipesOptions& options) {
                           add(kind, "--pipes", options.pipes, WholeRange{1, 1'000'000}, "Number of pipes");
                           add(kind, "--bends", options.bends, WholeRange{1, 100'000}, "Straight pieces per pipe");
                           add(kind, "--sides", options.sides, WholeRange{3, 4096}, "Corners of the cross-section");
                         });
  add_kind<PlantOptions>(
      command, "plant", "Storeys of rooms full of pipes, with floors, walls and doors, z up",
      {generate_plant, stream_plant}, [](CLI::App& kind, PlantOptions& options) {
        add(kind, "--storeys", options.storeys, WholeRange{1, 64}, "Number of storeys");
        add(kind, "--bays", options.bays, WholeRange{1, 256}, "Rooms along the aisle of each storey");
        add(kind, "--pipes", options.pipes, WholeRange{1, 10'000}, "Pipes on each side of a room");
        add(kind, "--bends", options.bends, WholeRange{1, 100'000}, "Straight pieces per pipe");
        add(kind, "--sides", options.sides, WholeRange{3, 4096}, "Corners of the cross-section");
      });
  add_kind<SpheresBehindWallOptions>(
      command, "spheres-behind-wall", "Spheres that a wall hides from +x",
      {generate_spheres_behind_wall, stream_spheres_behind_wall},
      [](CLI::App& kind, SpheresBehindWallOptions& options) {
        add(kind, "--spheres", options.spheres, WholeRange{1, 1'000'000}, "Number of spheres");
        add(kind, "--level", options.level, WholeRange{0, 8}, "Subdivisions of each sphere");
        add(kind, "--wall-cells", options.wall_cells, WholeRange{1, 4096}, "Cells along each edge of the wall");
      });
}

}  // namespace occlod::tool
