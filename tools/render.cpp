// Implements `occlod render SCENE.json|MESH|FILE.olod`: refines one view, or every frame of a camera path, and
// measures, draws or saves the result.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "accuracy.h"
#include "backend.h"
#include "beside_hlod.h"
#include "command_files.h"
#include "commands.h"
#include "drawing.h"
#include "explanation.h"
#include "global_options.h"
#include "hlod_scene.h"
#include "interrupt.h"
#include "json_output.h"
#include "measurement.h"
#include "object_textures.h"
#include "occlod/base.h"
#include "occlod/mesh_file.h"
#include "occlod/picture.h"
#include "occlod/refiner.h"
#include "occlod/view.h"
#include "refine_way.h"
#include "render_input.h"
#include "render_options.h"
#include "render_path.h"
#include "render_report.h"
#include "standard_streams.h"
#include "world_mesh.h"

namespace occlod::tool {
namespace {

void write_outputs(const RenderInput& input, const RenderOptions& options, const Measurement& measurement,
                   const View& view, std::span<const ObjectTexture> textures) {
  const std::span<const DrawObject> objects = measurement.objects();
  note_interrupts();
  if (!options.png.empty()) write_png(options.png, shade(measurement.items(), objects, view, {.textures = textures}));
  if (!options.birdseye.empty())
    write_png(options.birdseye, birdseye(objects, measurement.items(), view, View(birdseye_camera(objects, view))));
  if (options.mesh.empty()) return;
  const TriangleMesh mesh = world_mesh(input.objects, measurement.refinement(), options.mesh);
  for (const std::string& note : write_mesh(options.mesh, mesh)) print_note(note);
  note_lost_origin(options.mesh, mesh.origin);
}

void render_view(const RenderInput& input, const RenderOptions& options, RefineWay& way,
                 std::span<const hlod::PlacedHlod> hlods, std::span<const ObjectTexture> textures, FileGroup& outputs) {
  const View view(input.camera);
  Measurement measurement(input.objects);
  for (int i = 0; i < options.repeat; ++i) way.repeat(measurement, view, options.refine);
  write_outputs(input, options, measurement, view, textures);

  RenderResult result{input, options.refine, way, measurement, {}, {}, {}};
  if (options.reference) {
    const FullMeshPicture full(input.objects, view, textures);
    result.distance = full.distance_to(measurement.items(), measurement.objects());
    result.texture_slip_px = full.texture_slip_px(measurement.items(), measurement.objects());
    WronglyHidden wrongly_hidden(input.objects);
    const RefineOptions fixed = way.fixed(options.refine);
    wrongly_hidden.set_view(view, fixed);
    result.wrongly_hidden_px = wrongly_hidden.count(fixed, way.visibility());
  }
  std::vector<WayCost> ways;
  if (options.explain) {
    BesideHlod beside(input.objects, 1);
    beside.add(view, measurement);
    ways = costs_of_ways(beside, hlods);
  }
  outputs.commit();
  if (options.json) {
    Json report = report_of(result);
    if (options.explain) report["splits_or_hlod"] = to_json(ways);
    print_json(report);
    return;
  }
  print_report(result);
  if (!options.explain) return;
  print_explanation(*way.chooser(), measurement.refinement().stats, input.objects);
  print_ways(ways);
}

// Choosing effects costs trial views, which pay off over a path but not in a single view. From frame to frame occlusion
// is so cheap that it is always used unless a choice is asked for.
std::string default_occlusion(const RenderOptions& options) {
  const AutoWayOptions& way = options.auto_way;
  const bool is_asked_for = options.explain || !way.calibration.empty() || !way.save_calibration.empty();
  const bool pays = !options.input.path.empty() && !options.frame_to_frame;
  return is_asked_for || pays ? "auto" : "software";
}

BackendOptions backend_options(const RenderOptions& options) {
  BackendOptions backend = options.backend;
  if (backend.occlusion.empty()) backend.occlusion = default_occlusion(options);
  const bool is_auto = backend.occlusion == "auto";
  if (!is_auto && options.explain)
    throw Error({backend.occlusion, "--explain", "has no choice to explain", "use it with --occlusion auto"});
  if (backend.occlusion == "picture" && !options.frame_to_frame)
    throw Error({backend.occlusion, "--occlusion", "needs the picture of a frame before",
                 "use it with --path and --frame-to-frame"});
  return backend;
}

void add_files(const RenderOptions& options, const SceneDescription& scene, CommandFiles& files) {
  files.add_input("the scene to read", options.input.file);
  if (!options.auto_way.calibration.empty()) files.add_input("the calibration to read", options.auto_way.calibration);
  if (!options.auto_way.save_calibration.empty())
    files.add_output("--save-calibration", options.auto_way.save_calibration);
  if (const auto path = scene.paths.find(options.input.path); path != scene.paths.end() && !options.png.empty())
    for (int i = 0; i < path->second.frames; ++i) files.add_output("--png", numbered(options.png, i), ".png");
  else if (!options.png.empty())
    files.add_output("--png", options.png, ".png");
  if (!options.birdseye.empty()) files.add_output("--birdseye", options.birdseye, ".png");
  if (!options.mesh.empty()) files.add_mesh_output("--mesh", options.mesh);
}

void run(const RenderOptions& options) {
  handle_interrupts("render");
  const BackendOptions backend = backend_options(options);
  const SceneDescription scene = describe_render_input(options.input);
  CommandFiles files;
  add_files(options, scene, files);
  if (backend.occlusion == "gl-query") (void)make_backend(backend);  // fails before much is read and built
  const RenderInput input = load_render_input(options.input, scene);
  std::vector<LoadedHlod> hlods;  // to compare with
  if (options.explain) hlods = load_hlods_of(scene, options.input.file.parent_path(), options.input.use_cache);
  const std::vector<hlod::PlacedHlod> placed = placed_objects(hlods);
  const bool shows_textures = !options.png.empty() || options.reference;
  const SceneTextures textures(input.objects, shows_textures ? options.texture : TextureChoice::none);
  FileGroup outputs;
  RefineWay way(input.objects, backend, options.auto_way);
  if (input.path)
    render_path(input, options.refine, way,
                {options.png, options.frame_to_frame ? Following::frame_to_frame : Following::none, options.repeat,
                 options.json, options.explain && !options.json, textures.textures(), placed, &outputs});
  else
    render_view(input, options, way, placed, textures.textures(), outputs);
}

}  // namespace

void add_render(CLI::App& app) {
  CLI::App& command =
      *app.add_subcommand("render", "Refine a view or a camera path of a scene, and measure, draw or save the result");
  const auto options = std::make_shared<RenderOptions>();
  options->refine.threads = 0;  // as in all commands
  add_render_options(command, *options);
  command.callback([options, &command] {
    read_global_options(
        command, {.json = &options->json, .threads = &options->refine.threads, .use_cache = &options->input.use_cache});
    if (command.count("--device") > 0 && options->backend.occlusion != "gl-query")
      throw CLI::ValidationError("--device", "goes with --occlusion gl-query only");
    run(*options);
  });
}

}  // namespace occlod::tool
