// occlod hlod compare INPUT: one path drawn by several strategies on several devices, frame by frame in turns.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "command_files.h"
#include "global_options.h"
#include "hlod.h"
#include "hlod_costs.h"
#include "hlod_device.h"
#include "hlod_options.h"
#include "hlod_report.h"
#include "hlod_runs.h"
#include "hlod_scene.h"
#include "hlod_strategies.h"
#include "interrupt.h"
#include "option_values.h"
#include "progress.h"

namespace occlod::tool {
namespace {

struct Options {
  HlodSceneOptions scene;
  hlod::TraverseOptions traverse;
  std::vector<std::string> strategies = {"all"};
  std::vector<std::string> devices = {"software"};
  HlodCostOptions costs;
  int compared_frames = 0;
  std::string csv;
  bool json = false;
};

std::vector<hlod::Strategy> chosen_strategies(const Options& options) {
  std::vector<hlod::Strategy> chosen;
  for (const auto& [name, strategy] : strategies())
    if (options.strategies == std::vector<std::string>{"all"} ||
        std::find(options.strategies.begin(), options.strategies.end(), name) != options.strategies.end())
      chosen.push_back(strategy);
  return chosen;
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

void run(const Options& options) {
  handle_interrupts("hlod compare");
  const HlodRequest request = describe_hlod_request(options.scene);
  CommandFiles files;
  for (const auto& [what, path] : files_of(options.scene, request)) files.add_input(what, path);
  if (!options.csv.empty()) files.add_output("--csv", options.csv);
  add_files(files, options.costs);
  std::vector<HlodDevice> devices;
  for (const std::string& name : options.devices) devices.push_back(make_hlod_device(name));
  const HlodScene scene = load_hlod_scene(options.scene, request);
  std::vector<HlodRun> drawn;
  std::vector<Json> heads;
  const std::vector<hlod::DeviceCosts> costs = costs_of(devices, options.costs, chosen_strategies(options));
  for (std::size_t i = 0; i < devices.size(); ++i)
    for (const hlod::Strategy strategy : chosen_strategies(options)) {
      drawn.push_back({options.traverse, devices[i].device.get()});
      drawn.back().options.strategy = strategy;
      drawn.back().options.costs = costs[i];
      heads.push_back({{"device", devices[i].name}, {"strategy", name_of(strategy)}});
    }
  HlodRuns runs(scene, drawn, options.compared_frames);
  Progress progress;
  for (int i = 0; i < scene.path.frames; ++i) {
    note_interrupts();
    runs.draw(i);
    progress.show("drawing", static_cast<double>(i + 1) / scene.path.frames);
  }
  progress.clear();
  if (!options.csv.empty()) write_csv(options.csv, all_rows(heads, runs));
  for (std::size_t i = 0; i < heads.size(); ++i) heads[i].update(runs.summary(i));

  Json report = {{"scene", scene.name}, {"path", options.scene.view.path}};
  report.update(to_json(options.traverse));
  report["runs"] = heads;
  if (options.json) return print_json(report);
  const auto columns = run_columns(options.compared_frames > 0);
  print_titles(columns);
  for (const Json& head : heads) print_row(columns, head);
}

}  // namespace

void add_hlod_compare(CLI::App& hlod) {
  CLI::App& command = *hlod.add_subcommand("compare", "Draw one path by several strategies and devices, in one table");
  const auto options = std::make_shared<Options>();
  add_hlod_scene_options(command, options->scene);
  command.option_defaults()->group("Refinement");
  std::vector<std::string> names = {"all"};
  for (const auto& [name, strategy] : strategies()) names.push_back(name);
  command.add_option("--strategies", options->strategies, "Strategies to compare")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->transform(one_of(names))
      ->option_text("NAME,NAME,... [all]");
  add_traverse_options(command, options->traverse);
  command.option_defaults()->group("Device");
  command.add_option("--device", options->devices, fmt::format("What draws and answers: {}", hlod_device_names))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->transform(not_empty())
      ->option_text("NAME,NAME,... [software]");
  add_hlod_cost_options(command, options->costs);
  command.option_defaults()->group("Output");
  add_number(command, "--reference", options->compared_frames, WholeRange{0, 1'000'000},
             "Compare so many frames, spread evenly, with the input and with what vfc draws; 0: none")
      ->capture_default_str();
  add_file(command, "--csv", options->csv, "Write what is told of each frame of each run as comma-separated values");
  command.callback([options, &command] {
    read_global_options(command, {.json = &options->json, .use_cache = &options->scene.use_cache});
    run(*options);
  });
}

}  // namespace occlod::tool
