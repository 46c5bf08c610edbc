// bench_scratch: refinement from scratch along a camera path, each way to cull without and with software occlusion.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/timing.h"
#include "occlod/refiner.h"
#include "occlod/visibility.h"
#include "refine/tuning.h"
#include "render_input.h"
#include "support/frame_log.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

struct Options {
  std::filesystem::path scenes = OCCLOD_SCENES;
  std::string scene = "armadillo";
  std::string path = "orbit";
  std::vector<std::string> ways = {"subtree", "subtree+software", "star", "star+software"};
  std::vector<std::size_t> budgets = {10'000};
  std::vector<int> threads = {1};
  int frames = 24;  // of the path, evenly
  int repeat = 9;
};

// One way to refine, and what it took: for each frame of the path the times of all rounds.
struct Way {
  std::string name;
  RefineOptions options;
  bool occlusion = false;
  std::vector<RefinerLog> rounds;
  RefineStats stats;  // of the last frame
};

std::vector<Way> ways_of(const Options& options) {
  std::vector<Way> ways;
  for (const std::size_t budget : options.budgets)
    for (const std::string& name : options.ways)
      for (const int threads : options.threads) {
        Way way{threads == 1 ? name : fmt::format("{}, {} threads", name, threads),
                {},
                name.ends_with("+software"),
                {},
                {}};
        way.options.budget = budget;
        way.options.threads = threads;
        tune(way.options).culling = name.starts_with("star") ? Culling::star : Culling::subtree;
        ways.push_back(std::move(way));
      }
  return ways;
}

// Other programs can only add to a time: the least of all rounds, and of these the median over the frames.
double typical_ms(const Way& way, std::vector<double> FrameLog::*times) {
  std::vector<double> least = way.rounds.front().log.*times;
  for (const RefinerLog& round : way.rounds)
    for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], (round.log.*times)[i]);
  return median(least);
}

double median_ms(const Way& way) {
  std::vector<double> all;
  for (const RefinerLog& round : way.rounds) all.insert(all.end(), round.log.ms.begin(), round.log.ms.end());
  return median(all);
}

void run_round(const Options& options, const CameraPath& path, const std::vector<RefineObject>& objects, Way& way) {
  const std::unique_ptr<Visibility> software = make_software_occlusion();
  NoOcclusion none;
  Visibility& visibility = way.occlusion ? *software : static_cast<Visibility&>(none);
  RefinerLog round(objects);
  const auto step = [&](int i) {
    round.step(View(camera_at(path, i * path.frames / options.frames)), way.options, visibility, false);
  };
  step(0);  // touches memory
  round.log = {};
  for (int i = 0; i < options.frames; ++i) step(i);
  way.stats = round.last->stats;
  way.rounds.push_back(std::move(round));
}

void run(const Options& options) {
  tool::RenderInputOptions input_options;
  input_options.file = options.scenes / (options.scene + ".json");
  input_options.path = options.path;
  const tool::RenderInput input = tool::load_render_input(input_options);
  std::vector<RefineObject> objects;
  for (const LoadedObject& object : input.objects)
    objects.push_back({object.hierarchy.get(), object.object_to_world, object.two_sided});
  std::vector<Way> ways = ways_of(options);
  for (int round = 0; round < options.repeat; ++round)
    for (Way& way : ways) run_round(options, *input.path, objects, way);
  fmt::print(
      "| scene | path | budget | way | triangles | visits | queries | least ms | processor ms | median ms | Mtri/s | "
      "hash |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Way& way : ways) {
    const double ms = typical_ms(way, &FrameLog::ms);
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {:.3f} | {:.3f} | {:.3f} | {:.1f} | {:016x} |\n", options.scene,
               options.path, way.options.budget, way.name, way.stats.triangles, way.stats.visits, way.stats.queries, ms,
               typical_ms(way, &FrameLog::cpu_ms), median_ms(way), static_cast<double>(way.stats.triangles) / ms / 1e3,
               way.rounds.back().log.hash);
  }
}

int run(int argc, char** argv) {
  CLI::App app("Refinement from scratch along a path.", "bench_scratch");
  Options options;
  app.add_option("--scenes", options.scenes, "Folder of scenes")->check(CLI::ExistingDirectory);
  app.add_option("--scene", options.scene, "A name in it")->capture_default_str();
  app.add_option("--path", options.path, "A path of the scene")->capture_default_str();
  app.add_option("--ways", options.ways, "Culling, and what is hidden")
      ->capture_default_str()
      ->check(CLI::IsMember({"subtree", "subtree+software", "star", "star+software"}));
  app.add_option("--budgets", options.budgets, "Triangles")->capture_default_str();
  app.add_option("--threads", options.threads, "Threads")->capture_default_str();
  app.add_option("--frames", options.frames, "Frames of the path, evenly")->capture_default_str();
  add_repeat_option(app, options.repeat, "Rounds in which every way has its turn");
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
