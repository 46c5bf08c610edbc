#include "render_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <optional>

#include "option_values.h"

namespace occlod::tool {
namespace {

constexpr std::uint64_t max_triangles = 1'000'000'000'000;  // of a scene, whose objects may share hierarchies
constexpr std::uint64_t max_frames = 1'000'000;

void add_input_options(CLI::App& command, RenderOptions& options) {
  add_file(command, "INPUT", options.input.file, "A scene (.json), a mesh, or a hierarchy (.olod)")->required();
  CLI::Option* camera =
      add_name(command, "--camera", options.input.camera, "Camera of the scene")->capture_default_str();
  add_name(command, "--path", options.input.path,
           "Refine every frame of this camera path of the scene; not with --camera, --birdseye, --mesh and --reference")
      ->excludes(camera);
  add_size_options(command, options.input);
}

void add_refine_options(CLI::App& command, RefineOptions& refine) {
  command.option_defaults()->group("Refinement");
  add_number(command, "--budget", refine.budget, WholeRange{1, max_triangles},
             "Most triangles over all objects; never exceeded")
      ->capture_default_str();
  add_number(command, "--tolerance", refine.tolerance_px, RealRange{},
             "Spend no more of the budget than this error on the screen needs, in pixels");
  command.add_flag_callback(
      "--paper", [&refine] { refine.method = Method::paper; },
      "Refine as Birkholz & Rahn published it, to compare with: whole subtrees are tested, by cylinders, against the "
      "mesh after 300 and 2,500 splits");
}

void add_occlusion_options(CLI::App& command, RenderOptions& options) {
  RefineOptions& refine = options.refine;
  command.option_defaults()->group("Occlusion");
  add_choice<std::string>(
      command, "--occlusion", options.backend.occlusion,
      {{"auto", "auto"}, {"none", "none"}, {"software", "software"}, {"picture", "picture"}, {"gl-query", "gl-query"}},
      "What answers occlusion queries; picture: with --frame-to-frame, the depth of the frame before, where there is "
      "one; auto: in each view whatever pays. If not given: software; auto with --path but "
      "without --frame-to-frame, and with --explain or a calibration");
  command.add_flag_callback(
      "--conservative", [&refine] { refine.mode = OccluderMode::conservative; },
      "Let only what stays hidden wherever collapses may have moved the surface be hidden, on squares of 8x8 pixels: "
      "hides nothing that the full mesh shows, hides less, and takes longer. Else the current mesh hides as it is, and "
      "too much where it bulges out of the true surface");
}

void add_gl_options(CLI::App& command, BackendOptions& backend) {
  command.option_defaults()->group("Occlusion by OpenGL (--occlusion gl-query)");
  add_choice<std::string>(command, "--device", backend.device, {{"gl", "gl"}, {"egl", "egl"}, {"osmesa", "osmesa"}},
                          "How to create the OpenGL context; gl: as the machine offers");
}

void add_auto_options(CLI::App& command, RenderOptions& options) {
  command.option_defaults()->group("Choice of occlusion (--occlusion auto)");
  add_file(command, "--calibration", options.auto_way.calibration,
           "Read what the parts of a frame cost on this machine; measured if not given");
  add_file(command, "--save-calibration", options.auto_way.save_calibration,
           "Write what the parts of a frame cost, to repeat this run exactly");
  command.add_flag(
      "--explain", options.explain,
      "Print what was on, what it cost and what it saved, and where an HLOD of the scene, which is built for that, "
      "would be the faster way to the same error; with --json the latter only, as the rest is told in any case");
}

// A frame that is refined again would be the next frame, so it cannot be repeated.
void add_following_options(CLI::App& command, RenderOptions& options) {
  RefineOptions& refine = options.refine;
  command.option_defaults()->group("Frame to frame (with --frame-to-frame)");
  CLI::Option* following =
      command
          .add_flag("--frame-to-frame", options.frame_to_frame,
                    "With --path: start from the mesh of the frame before instead of from scratch; not with --repeat")
          ->needs(command.get_option("--path"))
          ->excludes(command.get_option("--repeat"));
  add_number(command, "--max-changes", refine.max_changes, WholeRange{0, max_triangles},
             "Most splits and merges in one frame, except what the budget forces; 0: no limit")
      ->capture_default_str()
      ->needs(following);
  add_number(
      command, "--time-limit", refine.time_limit_ms, RealRange{},
      "Milliseconds after which a frame splits and merges no more; 0: no limit. Results then depend on the clock")
      ->capture_default_str()
      ->needs(following);
  add_number(command, "--geomorph-frames", refine.geomorph_frames, WholeRange{0, max_frames},
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
