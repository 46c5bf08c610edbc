// bench_effects: the setting `auto` beside every fixed setting of occlusion, in the views of the shipped scenes and of
// bench/scenes.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "drawing.h"
#include "effects/fixed_settings.h"
#include "effects/followed_path.h"
#include "effects/scores.h"
#include "occlod/auto_refiner.h"
#include "occlod/visibility.h"
#include "refine/tuning.h"
#include "support/run_app.h"
#include "visibility/table.h"

namespace occlod::bench {
namespace {

namespace fs = std::filesystem;
using tool::Json;

constexpr int max_followed_rounds = 3;  // each is many frames
constexpr int views_until_settled = 3;  // one look ahead, one back, and a choice by both

struct Options {
  std::vector<std::string> scenes = {
      "armadillo", "armadillo_group", "planet_full", "planet_near",         "sponza",           "sibenik",
      "city",      "ww2_city",        "pipes",       "spheres_behind_wall", "ground_from_above"};
  std::vector<std::size_t> budgets = {10'000};
  int frames = 2;  // of each path
  int search = 2;  // rounds of all settings
  int repeat = 7;  // rounds of the finalists
  std::size_t finalists = 6;
  int follow = 60;
  fs::path calibration;
  fs::path out;
};

fs::path file_of(const std::string& scene) {
  if (fs::path(scene).extension() == ".json") return scene;
  const fs::path shipped = fs::path(OCCLOD_SCENES) / (scene + ".json");
  return fs::exists(shipped) ? shipped : fs::path(OCCLOD_BENCH_SCENES) / (scene + ".json");
}

// One setting and what it has scored.
struct Contestant {
  FixedSetting setting;
  Scores scores;
};

class Contest {
 public:
  Contest(SceneRun& run, ScoredViews& views, const Calibration& calibration, std::size_t budget)
      : run_(run),
        views_(views),
        calibration_(calibration),
        budget_(budget),
        refiner_(tool::refine_objects(run.objects)) {
    for (FixedSetting& setting : fixed_settings(budget)) {
      // Effects are by object.
      if (!setting.options.effects.empty())
        setting.options.effects.assign(run.objects.size(), setting.options.effects.front());
      contestants_.push_back({std::move(setting), {}});
    }
  }

  // Every setting in every view; then only the best are left, and the one without occlusion in front.
  void search(int rounds, std::size_t finalists) {
    for (int round = 0; round < rounds; ++round)
      for (std::size_t i = 0; i < views_.size(); ++i) {
        views_.draw(i, by(contestants_.front().setting));  // the caches know the view before anything is timed
        for (Contestant& contestant : contestants_) views_.add(i, by(contestant.setting), contestant.scores);
      }
    const auto first = contestants_.begin() + 1;
    std::sort(first, contestants_.end(),
              [](const Contestant& a, const Contestant& b) { return a.scores.score() < b.scores.score(); });
    contestants_.resize(std::min(contestants_.size(), 1 + finalists));
    for (Contestant& contestant : contestants_) contestant.scores = {};
  }

  // The finalists and both ways of `auto` in turns, each round in another order.
  void finish(int rounds) {
    AutoRefiner jumping = auto_refiner();
    std::vector<AutoRefiner> settled;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      settled.push_back(auto_refiner());
      for (int seen = 0; seen < views_until_settled; ++seen) (void)by(settled[i])(views_.view(i));
    }
    for (int round = 0; round < rounds; ++round)
      for (std::size_t i = 0; i < views_.size(); ++i) {
        const std::size_t ways = contestants_.size() + 2;
        for (std::size_t k = 0; k < ways; ++k) {
          const std::size_t way = (k + static_cast<std::size_t>(round)) % ways;
          if (way == contestants_.size()) {
            views_.add(i, by(jumping), jumping_, true);
            continue;
          }
          // Twice each: the first time brings the memory that it works on into the caches.
          if (way < contestants_.size()) {
            views_.draw(i, by(contestants_[way].setting));
            views_.add(i, by(contestants_[way].setting), contestants_[way].scores);
          } else {
            views_.draw(i, by(settled[i]));
            views_.add(i, by(settled[i]), settled_, true);
          }
        }
      }
    for (const AutoRefiner& refiner : settled)
      choices_ += std::string(choices_.empty() ? "" : " ") + (refiner.report().choice.backend ? "occlusion" : "none");
  }

  [[nodiscard]] Json row(const std::string& scene) const {
    const Scores& none = contestants_.front().scores;
    const auto best = std::min_element(contestants_.begin(), contestants_.end(), [](const auto& a, const auto& b) {
      return a.scores.score() < b.scores.score();
    });
    const double best_score = best->scores.score();
    return {{"scene", scene},
            {"budget", budget_},
            {"views", views_.size()},
            {"none_ms", none.frame_ms_mean()},
            {"none_px", none.error_px_mean()},
            {"best", best->setting.name},
            {"best_ms", best->scores.frame_ms_mean()},
            {"best_px", best->scores.error_px_mean()},
            {"best_to_none", best_score / none.score()},
            {"auto_ms", settled_.frame_ms_mean()},
            {"auto_px", settled_.error_px_mean()},
            {"auto_to_best", settled_.score() / best_score},
            {"jumping_to_best", jumping_.score() / best_score},
            {"choices", choices_}};
  }

 private:
  [[nodiscard]] AutoRefiner auto_refiner() const {
    AutoOptions options;
    options.calibration = calibration_;
    return AutoRefiner(tool::refine_objects(run_.objects), std::move(options));
  }
  [[nodiscard]] Refine by(AutoRefiner& refiner) const {
    RefineOptions options;
    options.budget = budget_;
    return [&refiner, options](const View& view) -> const Refinement& { return refiner.refine(view, options); };
  }
  Refine by(const FixedSetting& setting) {
    Visibility& visibility = setting.occlusion ? *run_.software : static_cast<Visibility&>(run_.none);
    return [this, &setting, &visibility](const View& view) -> const Refinement& {
      return refiner_.refine(view, setting.options, visibility);
    };
  }

  SceneRun& run_;
  ScoredViews& views_;
  const Calibration& calibration_;
  std::size_t budget_;
  Refiner refiner_;
  std::vector<Contestant> contestants_;
  Scores jumping_;  // one refiner that goes from view to view
  Scores settled_;  // one refiner a view, which it has seen before
  std::string choices_;
};

std::vector<Contestant> followed_settings(std::size_t budget) {
  RefineOptions options;
  options.budget = budget;
  tune(options).final_check = false;
  tune(options).level_step = 1;
  std::vector<Contestant> contestants = {{{"none", options, false}, {}}};
  contestants.push_back({{"stars", options}, {}});
  tune(options).ask_stars = false;
  contestants.push_back({{"subtrees", options}, {}});
  return contestants;
}

Table empty_table(const Options& options) {
  return {
      "effects",
      fmt::format("`auto` beside the best of all fixed settings. Score: frame (refinement, occlusion, item buffer; "
                  "CPU time of the thread, ms) times error (depth RMS, px, 0.1 added in squares), geometric means "
                  "over the views, medians of {} interleaved rounds. Settled: one refiner a view, which it has seen "
                  "before; jumping: one that goes from view to view and looks ahead in each.",
                  options.repeat),
      {{"scene", "scene"},
       {"budget", "budget"},
       {"views", "views"},
       {"none_ms", "none, ms"},
       {"none_px", "px"},
       {"best", "best fixed setting"},
       {"best_ms", "ms"},
       {"best_px", "px"},
       {"best_to_none", "score / none's"},
       {"auto_ms", "auto, ms"},
       {"auto_px", "px"},
       {"auto_to_best", "score / best's, settled"},
       {"jumping_to_best", "jumping"},
       {"choices", "chosen"}},
      {}};
}

// `auto` beside fixed settings that go on from frame to frame along the first path of a scene.
Json followed_row(SceneRun& run, const std::string& scene, const Options& options, const Calibration& calibration) {
  const auto& paths = run.description.paths;
  const auto moves = std::find_if(paths.begin(), paths.end(), [](const auto& path) { return !path.second.jump; });
  FollowedPath path(run, (moves == paths.end() ? paths.begin() : moves)->second, options.follow);
  RefineOptions refine_options;
  refine_options.budget = options.budgets.front();
  std::vector<Contestant> contestants = followed_settings(refine_options.budget);
  Scores by_auto;
  std::vector<std::string> choices;
  for (int round = 0; round < std::min(options.repeat, max_followed_rounds); ++round) {
    for (Contestant& contestant : contestants) {
      Refiner refiner(tool::refine_objects(run.objects));
      Visibility& visibility = contestant.setting.occlusion ? *run.software : static_cast<Visibility&>(run.none);
      path.follow(
          [&](const View& view) -> const Refinement& {
            return refiner.update(view, contestant.setting.options, visibility);
          },
          contestant.scores);
    }
    AutoOptions auto_options;
    auto_options.calibration = calibration;
    AutoRefiner refiner(tool::refine_objects(run.objects), std::move(auto_options));
    choices.clear();
    path.follow(
        [&](const View& view) -> const Refinement& {
          const Refinement& refinement = refiner.update(view, refine_options);
          const std::string choice = refiner.report().choice.backend ? "occlusion" : "none";
          if (choices.empty() || choices.back() != choice) choices.push_back(choice);
          return refinement;
        },
        by_auto);
  }
  const auto best = std::min_element(contestants.begin(), contestants.end(),
                                     [](const auto& a, const auto& b) { return a.scores.score() < b.scores.score(); });
  Json row = {{"scene", scene}, {"best", best->setting.name}};
  for (const Contestant& contestant : contestants) {
    const std::string key = contestant.setting.name;
    row[key + "_ms"] = contestant.scores.frame_ms_mean();
    row[key + "_px"] = contestant.scores.error_px_mean();
  }
  row["auto_ms"] = by_auto.frame_ms_mean();
  row["auto_px"] = by_auto.error_px_mean();
  row["auto_to_best"] = by_auto.score() / best->scores.score();
  row["choices"] = fmt::format("{}", fmt::join(choices, " "));
  return row;
}

Table empty_followed_table(const Options& options) {
  Table table{"effects_followed",
              fmt::format("From frame to frame along the first {} of 120 frames of each scene's first path that does "
                          "not jump, without the "
                          "first 15: `auto` beside fixed settings (software occlusion, no final check). Times and "
                          "errors as above; the error of every ninth frame.",
                          options.follow),
              {{"scene", "scene"}},
              {}};
  for (const Contestant& contestant : followed_settings(options.budgets.front())) {
    table.columns.push_back({contestant.setting.name + "_ms", contestant.setting.name + ", ms"});
    table.columns.push_back({contestant.setting.name + "_px", "px"});
  }
  table.columns.insert(table.columns.end(), {{"best", "best"},
                                             {"auto_ms", "auto, ms"},
                                             {"auto_px", "px"},
                                             {"auto_to_best", "score / best's"},
                                             {"choices", "chosen, in turn"}});
  return table;
}

Calibration calibration_of(const fs::path& file) {
  if (!file.empty() && fs::exists(file)) return read_calibration(file);
  std::vector<std::unique_ptr<Visibility>> backends;
  backends.push_back(make_software_occlusion());
  Calibration calibration = measure_calibration(backends);
  if (!file.empty()) write_calibration(file, calibration);
  return calibration;
}

void run(const Options& options) {
  const Calibration calibration = calibration_of(options.calibration);
  Table table = empty_table(options);
  Table followed = empty_followed_table(options);
  for (const std::string& scene : options.scenes) {
    const std::unique_ptr<SceneRun> scene_run = load_scene(file_of(scene), {});
    if (!scene_run) continue;
    if (options.follow > 0 && !scene_run->description.paths.empty() &&
        scene_run->is_decided_by(options.budgets.front()))
      followed.add(followed_row(*scene_run, scene, options, calibration));
    if (options.search == 0) continue;
    ScoredViews views(*scene_run, options.frames);
    for (const std::size_t budget : options.budgets) {
      if (!scene_run->is_decided_by(budget)) continue;
      fmt::print(stderr, "{}: {}\n", scene, budget);
      Contest contest(*scene_run, views, calibration, budget);
      contest.search(options.search, options.finalists);
      contest.finish(options.repeat);
      table.add(contest.row(scene));
      if (!options.out.empty()) write_text(options.out, csv(table));
    }
  }
  fmt::print("{}\n{}", markdown(table), markdown(followed));
  if (!options.out.empty() && options.follow > 0)
    write_text(fs::path(options.out).replace_filename(followed.name + ".csv"), csv(followed));
}

int run(int argc, char** argv) {
  CLI::App app("The setting `auto` beside every fixed setting of occlusion.", "bench_effects");
  Options options;
  app.add_option("--scene", options.scenes, "Scenes by name, or scene files")->capture_default_str();
  app.add_option("--budget", options.budgets, "Triangles")->capture_default_str();
  app.add_option("--frames", options.frames, "Frames of each path")->capture_default_str();
  app.add_option("--search", options.search, "Rounds of all settings; 0: only from frame to frame")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app.add_option("--follow", options.follow, "Frames of a path from frame to frame; 0: none")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000) & !CLI::Range(1, 15));
  app.add_option("--finalists", options.finalists, "Settings that are timed beside auto")->capture_default_str();
  add_repeat_option(app, options.repeat, "Rounds of the finalists and auto");
  app.add_option("--calibration", options.calibration, "Read from this file, or measured and written to it");
  app.add_option("--out", options.out, "CSV");
  return run_app(app, argc, argv, [&] { run(options); });
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
