// bench_hlod_compare INPUT: one path drawn by several strategies on several devices, frame by frame in turns. The
// tables of papers on HLODs come from it (scripts/hlod_tables.sh).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command_files.h"
#include "hlod/draw/node_images.h"
#include "hlod_cache.h"
#include "hlod_options.h"
#include "hlod_report.h"
#include "hlod_runs.h"
#include "hlod_scene.h"
#include "image_file.h"
#include "interrupt.h"
#include "occlod/base.h"
#include "option_values.h"
#include "papers/hlod_boxes.h"
#include "papers/hlod_costs.h"
#include "papers/trial_command.h"
#include "papers/trial_devices.h"
#include "progress.h"
#include "support/run_app.h"

namespace occlod::tool {
namespace {

struct Options {
  HlodSceneOptions scene;
  std::optional<hlod::TrialCacheOptions> cache;
  hlod::TrialOptions traverse;
  std::vector<std::string> strategies = {"all"};
  std::vector<std::string> devices = {"software"};
  HlodCostOptions costs;
  std::string record;
  std::string replay;  // instead of the devices
  int compared_frames = 0;
  std::string boxes;
  std::string csv;
  bool json = false;
};

std::vector<hlod::TrialStrategy> chosen_strategies(const Options& options) {
  std::vector<hlod::TrialStrategy> chosen;
  for (const auto& [name, strategy] : trial_strategies())
    if (options.strategies == std::vector<std::string>{"all"} ||
        std::find(options.strategies.begin(), options.strategies.end(), name) != options.strategies.end())
      chosen.push_back(strategy);
  return chosen;
}

// Of the nodes drawn in frame `frame`, numbered where there are several.
std::filesystem::path boxes_file(const Options& options, int frames, int frame) {
  const std::filesystem::path file = options.boxes;
  if (frames == 1) return file;
  return file.parent_path() / fmt::format("{}_{:05}{}", file.stem().string(), frame, file.extension().string());
}

void check(const Options& options, const HlodRequest& request, CommandFiles& files) {
  const std::size_t runs = chosen_strategies(options).size() * options.devices.size();
  if (runs > 1 && !(options.record.empty() && options.replay.empty() && options.boxes.empty()))
    throw Error({"options", "--record, --replay, --boxes", "are of one run",
                 "name one strategy by --strategies and one device by --device"});
  add_files(files, options.scene);
  if (!options.replay.empty()) files.add_input("the recording to replay", options.replay);
  if (!options.csv.empty()) files.add_output("--csv", options.csv);
  if (!options.record.empty()) files.add_output("--record", options.record);
  add_files(files, options.costs);
  for (int i = 0; !options.boxes.empty() && i < request.frames; ++i)
    files.add_output("--boxes", boxes_file(options, request.frames, i));
}

std::vector<TrialDevice> make_devices(const Options& options, const std::shared_ptr<hlod::NodeImages>& images) {
  std::vector<TrialDevice> devices;
  if (!options.replay.empty()) devices.push_back(replaying_device(options.replay));
  for (const std::string& name : options.devices)
    if (options.replay.empty()) devices.push_back(make_trial_device(name, images));
  const auto strategies = chosen_strategies(options);
  if (!options.replay.empty() && options.costs.calibration.empty() &&
      std::ranges::any_of(strategies, [](hlod::TrialStrategy s) { return hlod::needs_costs(s); }))
    throw Error({"--replay", options.replay, "a recording does not tell what the device's commands cost",
                 "give the calibration of the recorded run, --calibration"});
  return devices;
}

// What is drawn, and the head of what is told of it.
struct Drawn {
  std::deque<hlod::Trial> trials;  // which runs point to
  std::vector<HlodRun> runs;
  std::vector<Json> heads;
};

Drawn plan(const Options& options, const std::vector<TrialDevice>& devices, const std::vector<hlod::DeviceCosts>& costs,
           hlod::RenderDevice& oracle) {
  Drawn drawn;
  for (std::size_t i = 0; i < devices.size(); ++i)
    for (const hlod::TrialStrategy strategy : chosen_strategies(options)) {
      hlod::TrialOptions traverse = options.traverse;
      traverse.strategy = strategy;
      traverse.costs = costs[i];
      traverse.oracle = &oracle;
      drawn.trials.push_back(traverse.trial());
      drawn.runs.push_back({traverse.traverse(), devices[i].device.get(), &drawn.trials.back()});
      drawn.heads.push_back({{"device", devices[i].name}, {"strategy", name_of(strategy)}});
    }
  return drawn;
}

// With the frame's device and strategy in front.
std::vector<Json> all_rows(const std::vector<Json>& heads, const HlodRuns& runs) {
  std::vector<Json> all;
  for (std::size_t run = 0; run < heads.size(); ++run)
    for (const Json& row : runs.rows(run)) {
      all.push_back(heads[run]);
      all.back().update(row);
    }
  return all;
}

Json report_of(const Options& options, const HlodScene& scene, const std::vector<Json>& heads, const HlodRuns& runs,
               const hlod::DeviceCosts& costs) {
  Json report = {{"scene", scene.name}, {"path", options.scene.view.path}};
  report.update(to_json(options.traverse));
  if (options.cache) report["cache"] = to_json(*options.cache);
  report["runs"] = heads;
  if (heads.size() > 1) return report;
  report["costs"] = to_json(costs);
  report["frames"] = runs.rows(0);
  return report;
}

void run(const Options& options) {
  handle_interrupts("bench_hlod_compare");
  HlodSceneOptions scene_options = options.scene;
  if (options.cache) scene_options.paged = options.cache->cache();
  const HlodRequest request = describe_hlod_request(scene_options);
  CommandFiles files;
  check(options, request, files);
  const auto images = std::make_shared<hlod::NodeImages>();  // which all runs draw, one frame after the other
  const std::vector<TrialDevice> devices = make_devices(options, images);
  const HlodScene scene = load_hlod_scene(scene_options, request);
  for (const LoadedHlod& loaded : scene.hlods)
    if (options.cache && loaded.hlod->store() != nullptr) hlod::simulate_link(*loaded.hlod->store(), *options.cache);
  const std::vector<hlod::DeviceCosts> costs = costs_of(devices, options.costs, chosen_strategies(options));
  hlod::VirtualDevice oracle(hlod::device_presets().front(), images);  // whose time does not count
  Drawn drawn = plan(options, devices, costs, oracle);
  std::optional<hlod::RecordingDevice> recorder;
  if (!options.record.empty()) drawn.runs.front().device = &recorder.emplace(*devices.front().device);
  FileGroup outputs;
  HlodRuns runs(scene, drawn.runs, options.compared_frames);
  Progress progress;
  for (int i = 0; i < scene.path.frames; ++i) {
    note_interrupts();
    runs.draw(i);
    print_failures(scene.placed);
    if (!options.boxes.empty())
      write_png(boxes_file(options, scene.path.frames, i),
                picture_of_boxes(runs.front(0), scene.placed, View(camera_at(scene.path, i))));
    progress.show("drawing", static_cast<double>(i + 1) / scene.path.frames);
  }
  progress.clear();
  if (!options.csv.empty()) write_csv(options.csv, all_rows(drawn.heads, runs));
  if (recorder) write_recording(options.record, recorder->recording());
  outputs.commit();
  for (std::size_t i = 0; i < drawn.heads.size(); ++i) drawn.heads[i].update(runs.summary(i));
  if (options.json) return print_json(report_of(options, scene, drawn.heads, runs, costs.front()));
  const auto columns = run_columns(options.compared_frames > 0);
  print_titles(columns);
  for (const Json& head : drawn.heads) print_row(columns, head);
}

void add_options(CLI::App& app, Options& options) {
  add_hlod_scene_options(app, options.scene);
  add_trial_cache_options(app, options.cache);
  std::vector<std::string> names = {"all"};
  for (const auto& [name, strategy] : trial_strategies()) names.push_back(name);
  app.add_option("--strategies", options.strategies, "Strategies to compare")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->transform(one_of(names))
      ->option_text("NAME,NAME,... [all]");
  add_trial_options(app, options.traverse);
  CLI::Option* const device =
      app.add_option("--device", options.devices, fmt::format("What draws and answers: {}", trial_device_names))
          ->delimiter(',')
          ->allow_extra_args(false)
          ->transform(not_empty())
          ->option_text("NAME,NAME,... [software]");
  add_hlod_cost_options(app, options.costs);
  add_file(app, "--record", options.record, "Write what the device was told and answered, to repeat this run");
  add_file(app, "--replay", options.replay, "Take the answers and times of such a recording instead of a device")
      ->excludes(device);
  add_number(app, "--reference", options.compared_frames, WholeRange{0, 1'000'000},
             "Compare so many frames, spread evenly, with the input and with what vfc draws; 0: none")
      ->capture_default_str();
  add_file(app, "--boxes", options.boxes,
           "Write pictures of the nodes drawn and their boxes from above: blue where errors counted in full, red where "
           "hardly");
  add_file(app, "--csv", options.csv, "Write what is told of each frame of each run as comma-separated values");
  app.add_flag("--json", options.json, "Print the result as one JSON object; of one run with its frames");
}

}  // namespace
}  // namespace occlod::tool

int main(int argc, char** argv) {
  CLI::App app("One camera path of HLODs, drawn by several strategies and devices", "bench_hlod_compare");
  occlod::tool::Options options;
  occlod::tool::add_options(app, options);
  return occlod::bench::run_app(app, argc, argv, [&] { occlod::tool::run(options); });
}
