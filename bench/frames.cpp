// Along camera paths: refinement from scratch and from frame to frame, side by side.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "frames_vdpm.h"
#include "occlod/core/error.h"
#include "occlod/occlusion/software_occlusion.h"
#include "occlod/refine/refiner.h"
#include "occlod/scene/scene.h"
#include "oracle/cut_error.h"
#include "render_input.h"
#include "support/frame_log.h"
#include "support/median.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

struct Options {
  std::vector<std::string> scenes = {"armadillo", "armadillo_group", "planet_full", "planet_near",
                                     "sponza",    "sibenik",         "city",        "ww2_city"};
  std::vector<std::string> tables = {"scenes", "vdpm"};
  std::string path;
  std::vector<std::size_t> budgets = {10'000};
  int most_frames = 120;
  bool errors = true;
};

// What is compared: a path, a budget, and what is culled.
struct Subject {
  std::string scene, path_name;
  const CameraPath* path = nullptr;
  const std::vector<RefineObject>* objects = nullptr;
  RefineOptions options;
  bool occlusion = false;
};

// Errors below a tenth of a pixel are all alike; both may be unlimited, where the eye is inside bounds.
double ratio_of(double a, double b) {
  constexpr double nobody_sees = 0.1;
  if (std::isinf(a) && std::isinf(b)) return 1.0;
  return std::max(a, nobody_sees) / std::max(b, nobody_sees);
}

// The largest in medians.
std::string unevenness(const std::vector<double>& values) {
  const double middle = later_percentile(values, 0.5);
  return middle > 0.0 ? fmt::format("{:.1f}", later_percentile(values, 1.0) / middle) : "";
}

void compare(const Options& options, const Subject& subject) {
  const std::unique_ptr<Visibility> software = make_software_occlusion();
  NoOcclusion none;
  Visibility& visibility = subject.occlusion ? *software : static_cast<Visibility&>(none);
  RefinerLog scratch(*subject.objects), frames(*subject.objects);
  std::vector<double> ratios, changed_triangles;
  const int count = std::min(subject.path->frames, options.most_frames);
  for (int i = 0; i < count; ++i) {
    const View view(camera_at(*subject.path, i));
    scratch.step(view, subject.options, visibility, false);
    frames.step(view, subject.options, visibility, true);
    changed_triangles.push_back(static_cast<double>(frames.last->stats.changed_triangles));
    if (!options.errors) continue;
    ratios.push_back(ratio_of(oracle::cut_error(*subject.objects, *frames.last, view, visibility).quadric_px,
                              oracle::cut_error(*subject.objects, *scratch.last, view, visibility).quadric_px));
  }
  fmt::print(
      "| {} | {} | {} | {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {} | {:.1f} | {:.0f} | {} | {:.0f} | {} | "
      "{:016x} "
      "|\n",
      subject.scene, subject.path_name, subject.options.budget,
      subject.options.priority.culling == Culling::star ? "star" : "subtree", subject.occlusion ? "software" : "none",
      median(scratch.log.ms), later_percentile(frames.log.ms, 0.5), later_percentile(frames.log.ms, 0.95),
      later_percentile(frames.log.ms, 1.0), longest_run_above(frames.log.cpu_ms, 2.0),
      median(scratch.log.ms) / std::max(later_percentile(frames.log.ms, 0.5), 1e-3),
      later_percentile(frames.log.changes, 0.5), unevenness(frames.log.changes),
      later_percentile(changed_triangles, 0.5),
      ratios.empty() ? "| " : fmt::format("{:.3f} | {:.3f}", median(ratios), later_percentile(ratios, 0.95)),
      frames.log.hash);
  std::fflush(stdout);
}

void compare_path(const Options& options, const std::string& scene, const tool::RenderInput& input) {
  std::vector<RefineObject> objects;
  for (const LoadedObject& object : input.objects)
    objects.push_back({object.hierarchy.get(), object.object_to_world, object.two_sided});
  const std::size_t least = Refiner(objects).base_triangles();
  for (const std::size_t budget : options.budgets)
    for (const Culling culling : {Culling::subtree, Culling::star})
      for (const bool occlusion : {false, true}) {
        Subject subject{scene, input.path_name, &*input.path, &objects, {}, occlusion};
        subject.options.budget = std::max(budget, least);
        subject.options.priority.culling = culling;
        compare(options, subject);
      }
}

void compare_scenes(const Options& options) {
  fmt::print(
      "| scene | path | budget | culling | occlusion | scratch ms | frame ms | p95 | largest | above | times faster | "
      "changes | largest "
      "| "
      "changed triangles | error ratio | p95 | hash |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& scene : options.scenes) {
    tool::RenderInputOptions input;
    input.file = std::filesystem::path(OCCLOD_SCENES) / (scene + ".json");
    for (const auto& [name, path] : read_scene(input.file).paths) {
      if (!options.path.empty() && name != options.path) continue;
      input.path = name;
      try {
        compare_path(options, scene, tool::load_render_input(input));
      } catch (const Error& error) {
        fmt::print(stderr, "SKIPPED: {}\n", error.what());
      }
    }
  }
}

void run(const Options& options) {
  const auto asked = [&](const char* table) {
    return std::find(options.tables.begin(), options.tables.end(), table) != options.tables.end();
  };
  if (asked("scenes")) compare_scenes(options);
  if (!asked("vdpm")) return;
#ifdef OCCLOD_HAS_OPENMESH
  compare_with_vdpm();
#else
  fmt::print(stderr, "SKIPPED: OpenMesh was not there when this was built\n");
#endif
}

int run(int argc, char** argv) {
  CLI::App app("Refinement from frame to frame along the paths of scenes.", "bench_frames");
  Options options;
  app.add_option("SCENES", options.scenes, "Names of scenes in meshes/scenes")->capture_default_str();
  app.add_option("--tables", options.tables, "Paths of scenes, and OpenMesh's VDPM beside ours")
      ->capture_default_str()
      ->check(CLI::IsMember({"scenes", "vdpm"}));
  app.add_option("--path", options.path, "Only paths of this name");
  app.add_option("--budgets", options.budgets, "Triangles")->capture_default_str();
  app.add_option("--frames", options.most_frames, "Of each path at most")->capture_default_str();
  app.add_flag("!--no-errors", options.errors, "Do not compare errors, which takes longer than all else");
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
