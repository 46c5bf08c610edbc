// bench_report: what accuracy costs in time. Sweeps the knobs of refinement over scenes and camera paths and writes
// report.json, points.csv and parts of pictures into a folder, which report/page.py makes a page of.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "occlod/base.h"
#include "report/beside.h"
#include "report/document.h"
#include "report/machine.h"
#include "report/side_pictures.h"
#include "stopwatch.h"
#include "support/run_app.h"

namespace occlod::bench {
namespace {

namespace fs = std::filesystem;
using tool::Json;

struct Options {
  SweepOptions sweep;
  fs::path out = "out/report";
  std::string commit;
  bool is_small = false;
};

// Less than a minute.
void make_small(Options& options) {
  options.is_small = true;
  SweepOptions& sweep = options.sweep;
  sweep.scenes = {{"armadillo", "orbit"}, {"planet_full", "orbit"}, {"city", "fly_over"}, {"sponza", "walk"}};
  sweep.budgets = {500, 1'000, 2'000, 4'000};
  sweep.knob_budget = 2'000;
  sweep.size = {320, 240};
  sweep.hidden_size = {96, 72};
  sweep.bursts = 1;
  sweep.burst_frames = 4;
}

std::vector<SceneOutcomes> sweep_all(const std::vector<Setting>& settings, const SweepOptions& options) {
  std::vector<SceneOutcomes> outcomes;
  for (const auto& [scene, path] : options.scenes)
    if (const std::unique_ptr<SceneRun> run = load_scene(scene_file(scene), options.size)) {
      outcomes.push_back(sweep_scene(*run, path, settings, options));
      outcomes.back().ways = compare_with_hlods(*run, path, options);
    }
  if (outcomes.empty()) throw Error({"bench_report", "", "has no scene to work on", "set OCCLOD_MESHES"});
  return outcomes;
}

// The settings that are looked at side by side: what the paper's LOD gives for the recommended budget comes first.
std::vector<Setting> side_by_side(const std::vector<Setting>& settings, const Choice& choice) {
  const Setting& recommended = settings[choice.recommended];
  std::vector<Setting> chosen;
  for (const Setting& s : settings)
    if (s.series == "paper's LOD" && s.refine.budget == recommended.refine.budget) chosen.push_back(s);
  for (const std::size_t i : {choice.fastest, choice.recommended, choice.as_accurate, choice.most_accurate}) {
    const auto is_same = [&](const Setting& s) { return s.name == settings[i].name; };
    if (std::none_of(chosen.begin(), chosen.end(), is_same)) chosen.push_back(settings[i]);
  }
  return chosen;
}

// Writes SCENE_K.png, K = 0 for the full mesh, and tells what is in them.
Json write_pictures(const std::vector<Setting>& chosen, const Options& options) {
  const tool::ImageSize part = options.is_small ? tool::ImageSize{160, 120} : tool::ImageSize{320, 240};
  Json all = Json::array();
  for (const auto& [scene, path] : options.sweep.scenes) {
    const std::unique_ptr<SceneRun> run = load_scene(scene_file(scene), options.sweep.size);
    if (!run) continue;
    SidePictures pictures = draw_beside(*run, path, chosen, options.sweep, part);
    for (std::size_t k = 0; k <= chosen.size(); ++k) {
      const std::string file = fmt::format("{}_{}.png", run->description.name, k);
      write_png(options.out / file, k == 0 ? pictures.full : pictures.refined[k - 1]);
      all.push_back({{"scene", run->description.name},
                     {"frame", pictures.frame},
                     {"setting", k == 0 ? Json() : Json(chosen[k - 1].name)},
                     {"file", file}});
    }
  }
  return all;
}

void run(const Options& options) {
  const tool::Stopwatch stopwatch;
  fs::create_directories(options.out);
  const std::vector<Setting> settings = all_settings(options.sweep.budgets, options.sweep.knob_budget);
  const std::vector<SceneOutcomes> scenes = sweep_all(settings, options.sweep);
  const std::vector<Outcome> over_all = over_all_scenes(scenes);
  const Choice choice = choose(settings, over_all, options.sweep.knob_budget);
  const Table points = points_table(settings, scenes, over_all);

  Json report = {{"machine", about_this_machine()}, {"commit", options.commit}, {"small", options.is_small}};
  report.update(to_json(settings, scenes, over_all, choice, options.sweep));
  report["pictures"] = write_pictures(side_by_side(settings, choice), options);
  report["points"] = points.rows;
  report["seconds"] = stopwatch.milliseconds() / 1e3;
  write_text(options.out / "points.csv", csv(points));
  write_text(options.out / "report.json", report.dump(1) + "\n");
  fmt::print("recommended: {}\nhash: {}\n", settings[choice.recommended].name, report["hash"].get<std::string>());
}

void add_options(CLI::App& app, Options& options) {
  app.add_flag_callback(
         "--small", [&options] { make_small(options); }, "Three scenes, small pictures and budgets: for tests")
      ->trigger_on_parse();
  app.add_option_function<std::vector<std::string>>(
         "--scene",
         [&options](const std::vector<std::string>& names) {
           options.sweep.scenes.clear();
           for (const std::string& name : names) {
             const std::size_t colon = name.rfind(':');
             if (colon == std::string::npos) throw CLI::ValidationError("--scene", "is not SCENE:PATH: " + name);
             options.sweep.scenes.push_back({name.substr(0, colon), name.substr(colon + 1)});
           }
         },
         "Shipped scenes by name, or scene files, and a camera path of each")
      ->type_name("SCENE:PATH ...");
  app.add_option("--out", options.out, "Folder for JSON, CSV and pictures")->capture_default_str();
  app.add_option("--commit", options.commit, "What is measured, for the page");
}

int run(int argc, char** argv) {
  CLI::App app("What accuracy costs in time.", "bench_report");
  Options options;
  add_options(app, options);
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
