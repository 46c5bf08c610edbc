// occlod generate KIND ... -o FILE
#include "occlod/mesh/generate.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "commands.h"
#include "interrupt.h"
#include "json_output.h"
#include "occlod/io/write_mesh.h"
#include "progress.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

struct Output {
  std::string file;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

template <class Options, class Generate>
void run(const std::string& kind, const Options& options, const Output& output, const Generate& generate) {
  handle_interrupts("generate");
  Progress progress(output.progress);
  progress.show("generating " + output.file, std::nullopt);
  const Stopwatch stopwatch;
  const TriangleMesh mesh = generate(options);
  const double generate_ms = stopwatch.milliseconds();
  write_interruptibly(output.file, 0, progress, [&] { write_mesh(output.file, mesh); });
  progress.clear();
  const Json result = {{"generator", kind},
                       {"file", output.file},
                       {"vertices", mesh.vertex_count()},
                       {"triangles", mesh.triangle_count()},
                       {"generate_ms", generate_ms}};
  output.json ? print_json(result) : print_lines(result);
}

// One kind of scene; `add_options` adds the options of its own.
template <class Options, class Generate, class AddOptions>
void add_kind(CLI::App& generate_command, const std::string& kind, const std::string& about, const Generate& generate,
              const AddOptions& add_options) {
  CLI::App& command = *generate_command.add_subcommand(kind, about);
  const auto options = std::make_shared<Options>();
  const auto output = std::make_shared<Output>();
  add_options(command, *options);
  command.add_option("--seed", options->seed, "Seed of everything random")->capture_default_str();
  command.add_option("-o,--output", output->file, "Mesh to write: .ply, .obj, .off or .stl")->required();
  add_progress_option(command, output->progress);
  command.add_flag("--json", output->json, "Print one JSON object");
  command.callback([=] { run(kind, *options, *output, generate); });
}

}  // namespace

void add_generate(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("generate", "Make a test mesh from a few numbers");
  command.require_subcommand(1);
  add_kind<RoughPlanetOptions>(
      command, "rough-planet", "A sphere with seeded hills: 8 * 4^level triangles", generate_rough_planet,
      [](CLI::App& kind, RoughPlanetOptions& options) {
        kind.add_option("--level", options.level, "Subdivisions")->capture_default_str();
        kind.add_option("--amplitude", options.amplitude, "Largest displacement, of the radius")->capture_default_str();
        kind.add_option("--frequency", options.frequency, "Noise cells per radius")->capture_default_str();
        kind.add_option("--octaves", options.octaves, "Octaves of noise")->capture_default_str();
      });
  add_kind<CityOptions>(command, "city", "Blocks of buildings on a plane, z up", generate_city,
                        [](CLI::App& kind, CityOptions& options) {
                          kind.add_option("--blocks", options.blocks, "Blocks along each side")->capture_default_str();
                          kind.add_option("--facade-cells", options.facade_cells, "Cells along each edge of a wall")
                              ->capture_default_str();
                        });
  add_kind<PipesOptions>(
      command, "pipes", "A bundle of bent pipes in a unit cube", generate_pipes,
      [](CLI::App& kind, PipesOptions& options) {
        kind.add_option("--pipes", options.pipes, "Number of pipes")->capture_default_str();
        kind.add_option("--bends", options.bends, "Straight pieces of each")->capture_default_str();
        kind.add_option("--sides", options.sides, "Corners of the cross-section")->capture_default_str();
      });
  add_kind<SpheresBehindWallOptions>(
      command, "spheres-behind-wall", "Spheres that a wall hides from +x", generate_spheres_behind_wall,
      [](CLI::App& kind, SpheresBehindWallOptions& options) {
        kind.add_option("--spheres", options.spheres, "Number of spheres")->capture_default_str();
        kind.add_option("--level", options.level, "Subdivisions of each")->capture_default_str();
        kind.add_option("--wall-cells", options.wall_cells, "Cells along each edge of the wall")->capture_default_str();
      });
}

}  // namespace occlod::tool
