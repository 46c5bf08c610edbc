// Along camera paths: refinement from scratch and from frame to frame, side by side.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "occlod/occlusion/software_occlusion.h"
#include "occlod/refine/refiner.h"
#include "occlod/scene/scene.h"
#include "oracle/cut_error.h"
#include "render_input.h"
#include "stopwatch.h"
#include "support/median.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

struct Options {
  std::vector<std::string> scenes;
  std::string path;
  std::vector<std::size_t> budgets = {10'000};
  int most_frames = 120;
  bool errors = true;
};

// One way to refine all frames of a path.
struct Way {
  std::unique_ptr<Refiner> refiner;
  const Refinement* last = nullptr;
  std::vector<double> ms;
  std::vector<double> changes, changed_triangles;
  std::uint64_t hash = 0;
};

struct PathRun {
  const tool::RenderInput& input;
  RefineOptions options;
  bool occlusion;
  Way scratch, frames;
  double worst_ratio = 0.0;
  double mean_ratio = 0.0;
  double worst_quadric_ratio = 0.0, mean_quadric_ratio = 0.0;
};

void step(Way& way, const View& view, const RefineOptions& options, Visibility& visibility, bool update) {
  const tool::Stopwatch stopwatch;
  const Refinement& refinement =
      update ? way.refiner->update(view, options, visibility) : way.refiner->refine(view, options, visibility);
  way.last = &refinement;
  way.ms.push_back(stopwatch.milliseconds());
  way.changes.push_back(static_cast<double>(refinement.stats.new_splits + refinement.stats.merged_splits));
  way.changed_triangles.push_back(static_cast<double>(refinement.stats.changed_triangles));
  way.hash = way.hash * 31 + refinement.hash();
}

double percentile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

// Errors below a tenth of a pixel are all alike; both may be unlimited, where the eye is inside bounds.
double ratio_of(double a, double b) {
  constexpr double nobody_sees = 0.1;
  if (std::isinf(a) && std::isinf(b)) return 1.0;
  return std::max(a, nobody_sees) / std::max(b, nobody_sees);
}

void run_path(const Options& options, PathRun& run, const std::vector<RefineObject>& objects) {
  const std::unique_ptr<Visibility> software = make_software_occlusion();
  NoOcclusion none;
  Visibility& visibility = run.occlusion ? *software : static_cast<Visibility&>(none);
  const int frames = std::min(run.input.path->frames, options.most_frames);
  double sum = 0.0, quadric_sum = 0.0;
  for (int i = 0; i < frames; ++i) {
    const View view(camera_at(*run.input.path, i));
    step(run.scratch, view, run.options, visibility, false);
    step(run.frames, view, run.options, visibility, true);
    if (!options.errors) continue;
    const oracle::CutError scratch = oracle::cut_error(objects, *run.scratch.last, view, visibility);
    const oracle::CutError frame = oracle::cut_error(objects, *run.frames.last, view, visibility);
    const double ratio = ratio_of(frame.guaranteed_px, scratch.guaranteed_px);
    const double quadric = ratio_of(frame.quadric_px, scratch.quadric_px);
    run.worst_ratio = std::max(run.worst_ratio, ratio);
    run.worst_quadric_ratio = std::max(run.worst_quadric_ratio, quadric);
    sum += ratio;
    quadric_sum += quadric;
  }
  run.mean_ratio = sum / frames;
  run.mean_quadric_ratio = quadric_sum / frames;
}

void run(const Options& options) {
  fmt::print(
      "| scene | path | budget | culling | occlusion | scratch ms | update ms | p95 | max | scratch/update | changes | "
      "triangles | quadric mean | worst | guaranteed mean | worst | hash |\n");
  for (const std::string& scene : options.scenes) {
    const SceneDescription description = read_scene(scene);
    for (const auto& [name, path] : description.paths) {
      if (!options.path.empty() && name != options.path) continue;
      tool::RenderInputOptions input_options;
      input_options.file = scene;
      input_options.path = name;
      const tool::RenderInput input = tool::load_render_input(input_options);
      std::vector<RefineObject> objects;
      for (const LoadedObject& object : input.objects)
        objects.push_back({object.hierarchy.get(), object.object_to_world, object.two_sided});
      for (const std::size_t budget : options.budgets)
        for (const bool star : {false, true})
          for (const bool occlusion : {false, true}) {
            PathRun run{input, {}, occlusion, {}, {}};
            run.options.budget = std::max(budget, Refiner(objects).base_triangles());
            run.options.culling = star ? Culling::star : Culling::subtree;
            run.scratch.refiner = std::make_unique<Refiner>(objects);
            run.frames.refiner = std::make_unique<Refiner>(objects);
            run_path(options, run, objects);
            std::vector<double> later(run.frames.ms.begin() + 1, run.frames.ms.end());
            std::vector<double> changes(run.frames.changes.begin() + 1, run.frames.changes.end());
            std::vector<double> triangles(run.frames.changed_triangles.begin() + 1, run.frames.changed_triangles.end());
            fmt::print(
                "| {} | {} | {} | {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.1f} | {:.0f} | {:.0f} | {:.3f} | "
                "{:.3f} | {:.3f} | {:.3f} | {:016x} |\n",
                input.name, name, run.options.budget, star ? "star" : "subtree", occlusion ? "software" : "none",
                median(run.scratch.ms), median(later), percentile(later, 0.95), percentile(later, 1.0),
                median(run.scratch.ms) / median(later), median(changes), median(triangles), run.mean_quadric_ratio,
                run.worst_quadric_ratio, run.mean_ratio, run.worst_ratio, run.frames.hash);
            std::fflush(stdout);
          }
    }
  }
}

int run(int argc, char** argv) {
  CLI::App app("Refinement from frame to frame along the paths of scenes.", "bench_frames");
  Options options;
  app.add_option("SCENES", options.scenes, "Scene files")->required();
  app.add_option("--path", options.path, "Only paths of this name");
  app.add_option("--budgets", options.budgets, "Triangles")->capture_default_str();
  app.add_option("--frames", options.most_frames, "Of each path at most")->capture_default_str();
  app.add_flag("!--no-errors", options.errors, "Do not compare errors");
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
