// Implements `occlod hlod render INPUT`: draws the frames of a camera path, or of a static camera, and reports costs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "accuracy.h"
#include "command_files.h"
#include "drawing.h"
#include "global_options.h"
#include "hlod.h"
#include "hlod_cache.h"
#include "hlod_device.h"
#include "hlod_options.h"
#include "hlod_report.h"
#include "hlod_runs.h"
#include "hlod_scene.h"
#include "hlod_strategies.h"
#include "interrupt.h"
#include "node_textures.h"
#include "object_textures.h"
#include "occlod/device.h"
#include "option_values.h"
#include "render_path.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

struct Options {
  HlodSceneOptions scene;
  hlod::TraverseOptions traverse;
  std::string device = "software";
  int compared_frames = 0;
  std::string png;
  TextureChoice texture = TextureChoice::automatic;
  bool json = false;
};

// Names the picture of a frame, with its number if there are several.
std::filesystem::path picture_file(const std::string& file, int frames, int frame) {
  return frames > 1 ? numbered(file, frame) : std::filesystem::path(file);
}

void add_files(const Options& options, const HlodRequest& request, CommandFiles& files) {
  add_files(files, options.scene);
  for (int i = 0; !options.png.empty() && i < request.frames; ++i)
    files.add_output("--png", picture_file(options.png, request.frames, i), ".png");
}

void write_picture(const Options& options, const HlodScene& scene, NodeTextures& textures, const Front& front,
                   int frame) {
  const View view(camera_at(scene.path, frame));
  FrontMesh mesh;
  mesh.assign(front, scene.placed);
  ItemBuffer items;
  draw_items(items, mesh.objects(), view);
  write_png(picture_file(options.png, scene.path.frames, frame),
            shade_without_wire(items, mesh.objects(), view, textures.of(mesh)));
}

Json report_of(const Options& options, const HlodScene& scene, const HlodDevice& device, const hlod::DeviceCosts& costs,
               const HlodRuns& runs) {
  Json report = {
      {"scene", scene.name}, {"path", options.scene.view.path}, {"strategy", name_of(options.traverse.strategy)}};
  report.update(to_json(options.traverse));
  report["device"] = device.name;
  if (hlod::needs_costs(options.traverse.strategy)) report["costs"] = to_json(costs);
  if (options.scene.paged) report["cache"] = to_json(*options.scene.paged);
  if (!device.gl.is_null()) report["gl"] = device.gl;
  for (const LoadedHlod& hlod : scene.hlods) {
    Json counts = {{"source", hlod.source_name}};
    counts.update(counts_of(*hlod.hlod));
    report["hlods"].push_back(std::move(counts));
  }
  report["mean"] = runs.summary(0);
  report["frames"] = runs.rows(0);
  return report;
}

// Prints the line below the table: sums and maxima over all frames.
void print_cache(const hlod::CacheOptions& cache, const Json& told, double first_picture_ms) {
  const auto number = [&](const char* key) { return told[key].get<double>(); };
  fmt::print(
      "first picture after {:.0f} ms; frames of {:.3f} ms, 1 in 100 more than {:.3f} ms; at most {:.2f} of {:.2f} MB "
      "in "
      "memory; {:.2f} MB in {:.0f} meshes by {:.0f} reads, {:.0f} of them gone again; {:.0f} nodes failed\n",
      first_picture_ms, number("p50_wall_ms"), number("p99_wall_ms"), number("resident_bytes") * 1e-6,
      static_cast<double>(cache.budget_bytes) * 1e-6, number("bytes_loaded") * 1e-6, number("loads"), number("reads"),
      number("evictions"), number("failed"));
}

void run(const Options& options) {
  handle_interrupts("hlod render");
  const HlodRequest request = describe_hlod_request(options.scene);
  CommandFiles files;
  add_files(options, request, files);
  const HlodDevice device = make_hlod_device(options.device);
  hlod::TraverseOptions traverse = options.traverse;
  if (hlod::needs_costs(traverse.strategy)) traverse.costs = hlod::measure_costs(*device.device);
  const Stopwatch opening;
  const HlodScene scene = load_hlod_scene(options.scene, request);
  const HlodTextures textures(scene.hlods, options.scene.file.parent_path(),
                              options.png.empty() ? TextureChoice::none : options.texture);
  NodeTextures node_textures(scene.placed, textures);
  HlodRuns runs(scene, {{traverse, device.device.get()}}, options.compared_frames);
  const bool is_paged = options.scene.paged.has_value();
  const auto columns = frame_columns(options.compared_frames > 0, is_paged);
  if (!options.json) print_titles(columns);
  double first_picture_ms = 0.0;
  FileGroup pictures;
  for (int i = 0; i < scene.path.frames; ++i) {
    note_interrupts();
    runs.draw(i);
    if (i == 0) first_picture_ms = opening.milliseconds();
    print_failures(scene.placed);
    if (!options.png.empty()) write_picture(options, scene, node_textures, runs.front(0), i);
    if (!options.json) print_row(columns, runs.told(0));
  }
  pictures.commit();
  Json report = report_of(options, scene, device, traverse.costs, runs);
  report["first_picture_ms"] = first_picture_ms;
  if (options.json) return print_json(report);
  Json mean = report["mean"];
  mean["frame"] = "mean";
  print_row(mean_columns(options.compared_frames > 0, is_paged), mean);
  if (is_paged) print_cache(*options.scene.paged, mean, first_picture_ms);
}

}  // namespace

void add_hlod_render(CLI::App& hlod) {
  CLI::App& command = *hlod.add_subcommand("render", "Draw HLODs along a camera path, culled by occlusion queries");
  const auto options = std::make_shared<Options>();
  add_hlod_scene_options(command, options->scene);
  CLI::Option* const memory = add_cache_options(command, options->scene.paged);
  command.option_defaults()->group("Refinement");
  add_choice(command, "--strategy", options->traverse.strategy, strategies(),
             "What decides which nodes are drawn; docs/guide/hlod.md explains them");
  add_traverse_options(command, options->traverse);
  command.get_option("--within")->excludes(memory);  // splits are not read in parts
  command.option_defaults()->group("Device");
  add_name(command, "--device", options->device, fmt::format("What draws and answers: {}", hlod_device_names))
      ->capture_default_str();
  command.option_defaults()->group("Output");
  add_number(command, "--reference", options->compared_frames, WholeRange{0, 1'000'000},
             "Compare so many frames, spread evenly, with the input and with what vfc draws; 0: none")
      ->capture_default_str()
      ->excludes(memory);  // they need the whole HLOD
  add_file(command, "--png", options->png,
           "Write a picture; of several frames one each: view.png becomes view_00000.png, ...");
  add_texture_option(command, options->texture, "--png lays");
  command.callback([options, &command] {
    read_global_options(command, {.json = &options->json, .use_cache = &options->scene.use_cache});
    run(*options);
  });
}

}  // namespace occlod::tool
