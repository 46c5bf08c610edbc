// occlod render SCENE.json|MESH|FILE.olod: refines one view, or every frame of a camera path, and measures, draws or
// saves what comes of it.
#include <CLI/CLI.hpp>
#include <charconv>
#include <map>
#include <memory>
#include <string>

#include "accuracy.h"
#include "backend.h"
#include "commands.h"
#include "explanation.h"
#include "json_output.h"
#include "measurement.h"
#include "occlod/core/error.h"
#include "occlod/io/write_mesh.h"
#include "occlod/picture/picture.h"
#include "occlod/refine/refiner.h"
#include "occlod/view/view.h"
#include "refine_way.h"
#include "render_input.h"
#include "render_path.h"
#include "render_report.h"
#include "world_mesh.h"

namespace occlod::tool {
namespace {

struct Options {
  RenderInputOptions input;
  RefineOptions refine;
  BackendOptions backend;
  AutoWayOptions auto_way;
  std::vector<std::string> fixed_effects;  // of the options given, those that auto would choose
  bool explain = false;
  std::string png;
  std::string birdseye;
  std::string mesh;
  bool reference = false;
  bool frame_to_frame = false;
  int repeat = 1;
  bool json = false;
};

void write_outputs(const Options& options, const Measurement& measurement, const View& view) {
  const std::span<const DrawObject> objects = measurement.objects();
  if (!options.png.empty()) write_png(options.png, shade(measurement.items(), objects, view));
  if (!options.birdseye.empty())
    write_png(options.birdseye, birdseye(objects, measurement.items(), view, View(birdseye_camera(objects, view))));
  if (!options.mesh.empty()) write_mesh(options.mesh, world_mesh(objects));
}

void render_view(const RenderInput& input, const Options& options, RefineWay& way) {
  const View view(input.camera);
  Measurement measurement(input.objects);
  for (int i = 0; i < options.repeat; ++i) way.repeat(measurement, view, options.refine);
  write_outputs(options, measurement, view);

  RenderResult result{input, options.refine, way, measurement, {}, {}};
  if (options.reference) {
    result.distance = FullMeshPicture(input.objects, view).distance_to(measurement.items(), measurement.objects());
    WronglyHidden wrongly_hidden(input.objects);
    const RefineOptions fixed = way.fixed(options.refine);
    wrongly_hidden.set_view(view, fixed);
    result.wrongly_hidden_px = wrongly_hidden.count(fixed, way.visibility());
  }
  const Json report = report_of(result);
  options.json ? print_json(report) : print_lines(report);
  if (options.explain) print_explanation(*way.chooser(), measurement.refinement().stats, input.objects);
}

// Choosing takes looks that pay over a path and not in a single view. Effects that are given leave nothing to choose.
// From frame to frame occlusion costs so little that it is asked about in any case unless a choice is asked for.
std::string default_occlusion(const Options& options) {
  const AutoWayOptions& way = options.auto_way;
  const bool is_asked_for = options.explain || !way.calibration.empty() || !way.save_calibration.empty() ||
                            way.backends != AutoWayOptions().backends;
  const bool pays = !options.input.path.empty() && !options.frame_to_frame;
  return options.fixed_effects.empty() && (is_asked_for || pays) ? "auto" : "software";
}

BackendOptions backend_options(const Options& options) {
  BackendOptions backend = options.backend;
  if (backend.occlusion.empty()) backend.occlusion = default_occlusion(options);
  const bool is_auto = backend.occlusion == "auto";
  if (is_auto && !options.fixed_effects.empty())
    throw Error({"auto", options.fixed_effects.front(), "is what it chooses", "leave it out or name a backend"});
  if (!is_auto && options.explain)
    throw Error({backend.occlusion, "--explain", "has nothing to explain", "use it with auto"});
  if (options.json && options.explain)
    throw Error({"auto", "--explain", "is for people", "leave it out: --json says why, too"});
  return backend;
}

void run(const Options& options) {
  const BackendOptions backend = backend_options(options);
  if (backend.occlusion != "auto") (void)make_backend(backend);  // before much is read and built
  const RenderInput input = load_render_input(options.input);
  RefineWay way(input.objects, backend, options.auto_way);
  if (input.path)
    render_path(input, options.refine, way,
                {options.png, options.frame_to_frame ? Following::frame_to_frame : Following::none, options.repeat,
                 options.json, options.explain});
  else
    render_view(input, options, way);
}

bool parse_size(const std::string& text, ImageSize& size) {
  const char* end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  if (width.ec != std::errc() || width.ptr == end || *width.ptr != 'x') return false;
  const auto height = std::from_chars(width.ptr + 1, end, size.height);
  return height.ec == std::errc() && height.ptr == end && size.width > 0 && size.height > 0;
}

void add_input_options(CLI::App& command, Options& options) {
  command.add_option("SCENE", options.input.file, "A scene (.json), a mesh or a hierarchy (.olod)")->required();
  CLI::Option* camera =
      command.add_option("--camera", options.input.camera, "A camera of the scene by name")->capture_default_str();
  command.add_option("--path", options.input.path, "Every frame of a camera path of the scene, by name")
      ->excludes(camera);
  command
      .add_option_function<std::string>(
          "--size",
          [&options](const std::string& text) {
            ImageSize size;
            if (!parse_size(text, size)) throw CLI::ValidationError("--size", "is not WIDTHxHEIGHT in pixels: " + text);
            options.input.size = size;
          },
          "Size of the image instead of the camera's own")
      ->type_name("WxH");
  command.add_flag("--orthographic", options.input.orthographic,
                   "Parallel rays, showing as much at the distance of the camera's target");
  command.add_flag("!--no-cache", options.input.use_cache, "Build hierarchies anew and keep none");
}

// Of "adaptive" or ascending numbers.
std::vector<std::uint32_t> parse_occluder_splits(const std::vector<std::string>& steps) {
  std::vector<std::uint32_t> splits;
  if (steps.size() == 1 && steps[0] == "adaptive") return splits;
  for (const std::string& step : steps) {
    std::uint32_t value = 0;
    if (!CLI::detail::lexical_cast(step, value) || (!splits.empty() && value <= splits.back()))
      throw CLI::ValidationError("--occluder-splits", "is not adaptive or ascending numbers: " + step);
    splits.push_back(value);
  }
  return splits;
}

void add_weight(CLI::App& command, const std::string& name, double& exponent, const std::string& of) {
  command.add_option(name, exponent, "star: exponent of " + of + " in a split's priority; 0 = not weighed")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
}

// Options that fix what `auto` would choose.
void add_effect_options(CLI::App& command, Options& options) {
  RefineOptions& refine = options.refine;
  const auto note = [&options](const char* name) { options.fixed_effects.emplace_back(name); };
  command
      .add_option_function<std::uint32_t>(
          "--levels",
          [&refine, note](const std::uint32_t& levels) {
            refine.queries.level_step = levels;
            note("--levels");
          },
          "Ask about occlusion on every N-th level of the forest; 2 when not given")
      ->check(CLI::PositiveNumber);
  command
      .add_option_function<std::vector<std::string>>(
          "--occluder-splits",
          [&refine, note](const std::vector<std::string>& steps) {
            refine.occluder.splits = parse_occluder_splits(steps);
            note("--occluder-splits");
          },
          "Draw the occluder after so many splits, e.g. 300,2500; adaptive or not given: when the mesh has changed "
          "enough")
      ->delimiter(',')
      ->allow_extra_args(false);
  const auto add_switch = [&command, note](const char* name, bool& on, const char* about) {
    command.add_flag_callback(
        name,
        [&on, note, name] {
          on = false;
          note(name);
        },
        about);
  };
  add_switch("--no-retest", refine.occluder.retest_hidden, "Do not ask again about what an older occluder hid");
  add_switch("--no-final-check", refine.queries.final_check, "Do not ask about hidden parts before the final mesh");
  add_switch("--no-stars", refine.queries.ask_stars,
             "star: ask about subtrees only, not about what each split changes");
}

void add_refine_options(CLI::App& command, RefineOptions& refine) {
  static const std::map<std::string, Culling> cullings = {{"subtree", Culling::subtree}, {"star", Culling::star}};
  static const std::map<std::string, Proxy> proxies = {
      {"sphere", Proxy::sphere}, {"box", Proxy::box}, {"cylinder", Proxy::cylinder}};
  static const std::map<std::string, OccluderMode> modes = {{"paper", OccluderMode::paper},
                                                            {"conservative", OccluderMode::conservative}};
  command.add_option("--budget", refine.budget, "Triangles over all objects; never exceeded")->capture_default_str();
  command.add_option("--tolerance", refine.tolerance_px, "Stop at this screen error, pixels; 0 = use the budget up")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  command.add_option("--culling", refine.priority.culling, "subtree (the paper) or star; star when not given")
      ->transform(CLI::CheckedTransformer(cullings));
  command
      .add_option("--proxy", refine.queries.proxy, "Bounds to ask about: box, cylinder or sphere; box when not given")
      ->transform(CLI::CheckedTransformer(proxies));
  command
      .add_option(
          "--mode", refine.occluder.mode,
          "paper: the occluder is the current mesh as it is; conservative: moved back by its error bounds, so that "
          "it hides nothing that is visible; paper when not given")
      ->transform(CLI::CheckedTransformer(modes));
  add_weight(command, "--visible-exponent", refine.priority.visible_exponent, "the visible share of a split's faces");
  add_weight(command, "--grazing-exponent", refine.priority.grazing_exponent,
             "one over the cosine under which they are seen");
  add_weight(command, "--forced-exponent", refine.priority.forced_exponent,
             "one over the unseen splits that it forces");
}

void add_backend_options(CLI::App& command, BackendOptions& backend) {
  command
      .add_option(
          "--occlusion", backend.occlusion,
          "Who decides what is hidden; auto: whatever pays in each view. When not given, software; with --path, but "
          "not --frame-to-frame, and with --explain or a calibration auto, unless what it chooses is given")
      ->check(CLI::IsMember({"auto", "none", "software", "gl-query", "gl-mark", "gl-compute"}));
  command
      .add_option("--gl-platform", backend.gl_platform,
                  "Where OpenGL gets its context; what the machine offers when not given")
      ->check(CLI::IsMember({"egl", "osmesa"}));
  command
      .add_option("--flight", backend.flight, "OpenGL: questions under way at once; the backend's own when not given")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--query-window", backend.window,
                  "gl-query: of those, queries that OpenGL holds at once; 0 or not given = measured")
      ->check(CLI::NonNegativeNumber);
  command
      .add_option("--occlusion-divisor", backend.divisor,
                  "gl-query, gl-mark: draw proxies into a target smaller by so much in each direction")
      ->check(CLI::PositiveNumber);
  command.add_flag("--conservative-queries", backend.conservative,
                   "gl-query: let the driver say visible where it is quicker (OpenGL 4.3)");
}

void add_auto_options(CLI::App& command, Options& options) {
  command.add_option("--backends", options.auto_way.backends, "auto: backends to choose from")
      ->capture_default_str()
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"software", "gl-query", "gl-mark", "gl-compute"}));
  command.add_option("--calibration", options.auto_way.calibration,
                     "auto: what this machine's parts of a frame cost, from a file; measured when not given");
  command.add_option("--save-calibration", options.auto_way.save_calibration,
                     "auto: write what was measured, to repeat this run exactly");
  command.add_flag("--explain", options.explain, "auto: print what was on, what it cost and what it saved");
}

void add_output_options(CLI::App& command, Options& options) {
  CLI::Option* path = command.get_option("--path");
  command.add_option("--png", options.png, "Write a picture of the view; with --path one of each frame, numbered");
  command
      .add_option("--birdseye", options.birdseye, "Write a picture from above: seen triangles bright, unseen ones dark")
      ->excludes(path);
  command.add_option("--mesh", options.mesh, "Write the refined mesh, all objects in world space")->excludes(path);
  command
      .add_flag("--reference", options.reference,
                "Compare the picture with that of the full mesh, and count what occlusion hides wrongly")
      ->excludes(path);
  command.add_option("--repeat", options.repeat, "Refine so often; times are medians")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command.add_flag("--json", options.json, "Print one JSON object");
}

// A frame that is refined again is the frame after it: there is nothing to repeat.
void add_following_options(CLI::App& command, Options& options) {
  RefineOptions& refine = options.refine;
  CLI::Option* following = command
                               .add_flag("--frame-to-frame", options.frame_to_frame,
                                         "Go on from the mesh of the frame before instead of refining from scratch")
                               ->needs(command.get_option("--path"))
                               ->excludes(command.get_option("--repeat"));
  command
      .add_option("--hysteresis", refine.update.hysteresis,
                  "A split that is applied gives way only to what matters more by this part; below 1")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 0.999))
      ->needs(following);
  command
      .add_option("--most-changes", refine.update.most_changes,
                  "Splits and merges in one frame, but for what the budget forces; 0 = no limit")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber)
      ->needs(following);
  command
      .add_option("--time-limit", refine.update.time_limit_ms,
                  "No further splits and merges in a frame after so many milliseconds; 0 = no limit. Results then "
                  "depend on the clock")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber)
      ->needs(following);
  command
      .add_option("--geomorph-frames", refine.update.geomorph_frames,
                  "Vertices that appear slide from their parents for so many frames")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber)
      ->needs(following);
}

}  // namespace

void add_render(CLI::App& app) {
  CLI::App& command =
      *app.add_subcommand("render", "Refine a view or a camera path of a scene and measure, draw or save it");
  const auto options = std::make_shared<Options>();
  add_input_options(command, *options);
  add_refine_options(command, options->refine);
  add_effect_options(command, *options);
  options->backend.occlusion.clear();
  add_backend_options(command, options->backend);
  add_auto_options(command, *options);
  add_output_options(command, *options);
  add_following_options(command, *options);
  command.callback([options] { run(*options); });
}

}  // namespace occlod::tool
