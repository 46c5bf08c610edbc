#include "render_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <optional>

#include "option_values.h"

namespace occlod::tool {
namespace {

constexpr std::uint64_t max_triangles = 1'000'000'000'000;  // of a scene: its objects may share hierarchies
constexpr std::uint64_t max_questions = 1'000'000;
constexpr std::uint64_t max_frames = 1'000'000;
constexpr double largest_exponent = 8.0;
constexpr double largest_hysteresis = 0.999;

void add_input_options(CLI::App& command, RenderOptions& options) {
  add_file(command, "SCENE", options.input.file, "A scene (.json), a mesh or a hierarchy (.olod)")->required();
  CLI::Option* camera =
      add_name(command, "--camera", options.input.camera, "Camera of the scene")->capture_default_str();
  add_name(command, "--path", options.input.path,
           "Refine every frame of this camera path of the scene; not with --camera, --birdseye, --mesh and --reference")
      ->excludes(camera);
  add_size_options(command, options.input);
}

void add_exponent(CLI::App& command, const std::string& name, double& exponent, const std::string& of) {
  add_number(command, name, exponent, RealRange{0.0, largest_exponent},
             "star: exponent of " + of + " in the priority of a split; 0: ignored")
      ->capture_default_str();
}

void add_refine_options(CLI::App& command, RefineOptions& refine) {
  command.option_defaults()->group("Refinement");
  add_number(command, "--budget", refine.budget, WholeRange{1, max_triangles},
             "Most triangles over all objects; never exceeded")
      ->capture_default_str();
  add_number(command, "--tolerance", refine.tolerance_px, RealRange{},
             "Stop when no visible split has a larger guaranteed screen error, in pixels; 0: spend the whole budget")
      ->capture_default_str();
  add_choice(
      command, "--culling", refine.priority.culling, {{"subtree", Culling::subtree}, {"star", Culling::star}},
      "What is tested before a split: subtree (as in the paper): whether anything below it may be visible; star: "
      "also whether the faces that it changes are");
  add_exponent(command, "--visible-exponent", refine.priority.visible_exponent, "the visible share of its faces");
  add_exponent(command, "--grazing-exponent", refine.priority.grazing_exponent,
               "1 / cosine of the angle between its faces and the view");
  add_exponent(command, "--forced-exponent", refine.priority.forced_exponent, "1 / (1 + unseen splits that it forces)");
}

// Of "adaptive" or ascending numbers.
std::vector<std::uint32_t> parse_occluder_splits(const std::vector<std::string>& steps) {
  std::vector<std::uint32_t> splits;
  if (steps.size() == 1 && steps[0] == "adaptive") return splits;
  for (const std::string& step : steps) {
    const auto value = whole_number(step);
    if (!value || *value > max_elements || (!splits.empty() && *value <= splits.back()))
      throw CLI::ValidationError(
          "--occluder-splits",
          fmt::format("{} is neither adaptive alone nor one of ascending whole numbers from 0 to {}", shown(step),
                      max_elements));
    splits.push_back(static_cast<std::uint32_t>(*value));
  }
  return splits;
}

// Options that fix what `auto` would choose.
void add_effect_options(CLI::App& command, RenderOptions& options) {
  RefineOptions& refine = options.refine;
  const auto note = [&options](const char* name) { options.fixed_effects.emplace_back(name); };
  command
      .add_option_function<std::uint32_t>(
          "--levels",
          [&refine, note](const std::uint32_t& levels) {
            refine.queries.level_step = levels;
            note("--levels");
          },
          "Test subtrees on every N-th level of the hierarchy only; 2 if not given")
      ->transform(in_range(WholeRange{1, 1000}))
      ->type_name("N");
  command
      .add_option_function<std::vector<std::string>>(
          "--occluder-splits",
          [&refine, note](const std::vector<std::string>& steps) {
            refine.occluder.splits = parse_occluder_splits(steps);
            note("--occluder-splits");
          },
          "Draw the occluder after these numbers of splits, e.g. 300,2500; adaptive (if not given): at a third of "
          "the budget in triangles and at sixths of that")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->option_text("N,N,...|adaptive");
  const auto add_switch = [&command, note](const char* name, bool& on, const char* about) {
    command.add_flag_callback(
        name,
        [&on, note, name] {
          on = false;
          note(name);
        },
        about);
  };
  add_switch("--no-retest", refine.occluder.retest_hidden, "Do not test again what an older occluder hid");
  add_switch("--no-final-check", refine.queries.final_check, "Do not test what is hidden again before the final mesh");
  add_switch("--no-stars", refine.queries.ask_stars, "star: test subtrees only, not the faces that each split changes");
}

void add_occlusion_options(CLI::App& command, RenderOptions& options) {
  RefineOptions& refine = options.refine;
  command.option_defaults()->group("Occlusion");
  add_choice<std::string>(
      command, "--occlusion", options.backend.occlusion,
      {{"auto", "auto"},
       {"none", "none"},
       {"software", "software"},
       {"gl-query", "gl-query"},
       {"gl-mark", "gl-mark"},
       {"gl-compute", "gl-compute"}},
      "What answers occlusion queries; auto: in each view whatever pays. If not given: software; auto with --path but "
      "without --frame-to-frame, and with --explain, --backends or a calibration, unless an option fixes what it would "
      "choose");
  add_choice(command, "--mode", refine.occluder.mode,
             {{"paper", OccluderMode::paper}, {"conservative", OccluderMode::conservative}},
             "paper: the current mesh is the occluder as it is; where it bulges out of the true surface it hides too "
             "much. conservative: only what stays hidden wherever collapses may have moved the surface, on squares of "
             "8x8 pixels; hides nothing that the full mesh shows, hides less, and takes longer");
  add_choice(command, "--proxy", refine.queries.proxy,
             {{"box", Proxy::box}, {"cylinder", Proxy::cylinder}, {"sphere", Proxy::sphere}},
             "Bounding volume by which a subtree is tested");
  add_effect_options(command, options);
}

void add_gl_options(CLI::App& command, BackendOptions& backend) {
  command.option_defaults()->group("Occlusion by OpenGL (--occlusion gl-...)");
  add_choice<std::string>(command, "--gl-platform", backend.gl_platform, {{"egl", "egl"}, {"osmesa", "osmesa"}},
                          "How to create the OpenGL context; whatever the machine offers if not given");
  add_number(command, "--flight", backend.flight, WholeRange{1, max_questions},
             "Queries under way at once; the backend's own number if not given");
  add_number(command, "--query-window", backend.window, WholeRange{0, max_questions},
             "gl-query: of those, queries that OpenGL holds at once; measured if 0 or not given");
  add_number(command, "--occlusion-divisor", backend.divisor, WholeRange{1, 1024},
             "gl-query, gl-mark: test at a resolution so many times smaller in each direction");
  command.add_flag("--conservative-queries", backend.conservative,
                   "gl-query: let the driver answer visible where that is faster (OpenGL 4.3)");
}

void add_auto_options(CLI::App& command, RenderOptions& options) {
  command.option_defaults()->group("Choice of occlusion (--occlusion auto)");
  command.add_option("--backends", options.auto_way.backends, "Backends to choose from")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->transform(one_of({"software", "gl-query", "gl-mark", "gl-compute"}))
      ->option_text("NAME,NAME,... [software]");
  add_file(command, "--calibration", options.auto_way.calibration,
           "Read what the parts of a frame cost on this machine; measured if not given");
  add_file(command, "--save-calibration", options.auto_way.save_calibration,
           "Write what the parts of a frame cost, to repeat this run exactly");
  command.add_flag(
      "--explain", options.explain,
      "Print what was on, what it cost and what it saved, and where an HLOD of the scene, which is built for that, "
      "would be the faster way to the same error; with --json the latter only, as the rest is told in any case");
}

// A frame that is refined again is the frame after it: there is nothing to repeat.
void add_following_options(CLI::App& command, RenderOptions& options) {
  RefineOptions& refine = options.refine;
  command.option_defaults()->group("Frame to frame (with --frame-to-frame)");
  CLI::Option* following =
      command
          .add_flag("--frame-to-frame", options.frame_to_frame,
                    "With --path: start from the mesh of the frame before instead of from scratch; not with --repeat")
          ->needs(command.get_option("--path"))
          ->excludes(command.get_option("--repeat"));
  add_number(command, "--hysteresis", refine.update.hysteresis, RealRange{0.0, largest_hysteresis},
             "Relative margin by which a candidate must exceed an applied split to replace it")
      ->capture_default_str()
      ->needs(following);
  add_number(command, "--max-changes", refine.update.max_changes, WholeRange{0, max_triangles},
             "Most splits and merges in one frame, except what the budget forces; 0: no limit")
      ->capture_default_str()
      ->needs(following);
  add_number(
      command, "--time-limit", refine.update.time_limit_ms, RealRange{},
      "Milliseconds after which a frame splits and merges no more; 0: no limit. Results then depend on the clock")
      ->capture_default_str()
      ->needs(following);
  add_number(command, "--geomorph-frames", refine.update.geomorph_frames, WholeRange{0, max_frames},
             "Frames in which a new vertex slides from its parent to its place; 0: at once")
      ->capture_default_str()
      ->needs(following);
}

void add_output_options(CLI::App& command, RenderOptions& options) {
  command.option_defaults()->group("Output");
  CLI::Option* path = command.get_option("--path");
  add_file(command, "--png", options.png,
           "Write a picture of the view; with --path one of every frame: view.png becomes view_00000.png, ...");
  add_file(command, "--birdseye", options.birdseye,
           "Write a picture from above: visible triangles bright, the others dark")
      ->excludes(path);
  add_file(command, "--mesh", options.mesh,
           "Write the refined mesh, all objects in world space: .ply, .obj, .glb, .off or .stl")
      ->excludes(path);
  add_texture_option(command, options.texture, "--png and --reference lay");
  command
      .add_flag("--reference", options.reference,
                "Compare the picture with that of the full mesh, and count the pixels that occlusion hides wrongly")
      ->excludes(path);
  add_number(command, "--repeat", options.repeat, WholeRange{1, 1'000'000}, "Refine so many times; times are medians")
      ->capture_default_str();
}

}  // namespace

void add_render_options(CLI::App& command, RenderOptions& options) {
  options.backend.occlusion.clear();
  add_input_options(command, options);
  add_refine_options(command, options.refine);
  add_occlusion_options(command, options);
  add_gl_options(command, options.backend);
  add_auto_options(command, options);
  add_output_options(command, options);
  add_following_options(command, options);
}

}  // namespace occlod::tool
