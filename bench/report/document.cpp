#include "report/document.h"

#include <fmt/format.h>

#include <limits>
#include <string>
#include <utility>

#include "occlod/base.h"
#include "report/choice.h"
#include "report/measures.h"

namespace occlod::bench {
namespace {

using tool::Json;

// For each setting; larger is worse, also of measures of which more is better.
std::vector<Cost> costs(const std::vector<Outcome>& outcomes, std::size_t measure) {
  std::vector<Cost> result;
  for (const Outcome& outcome : outcomes) {
    const double value = outcome.measured[measure];
    const double error = measures[measure].less_is_better ? value : -value;
    // Equal to the full mesh in every pixel: better than all others.
    result.push_back({outcome.ms, error == -std::numeric_limits<double>::infinity() ? -1e9 : error});
  }
  return result;
}

Json names_of(const std::vector<std::size_t>& places, const std::vector<Setting>& settings) {
  Json names = Json::array();
  for (const std::size_t i : places) names.push_back(settings[i].name);
  return names;
}

Json to_json(const Choice& choice, const std::vector<Setting>& settings) {
  Json within = Json::array();
  for (std::size_t i = 0; i < choice.within.size(); ++i) {
    const std::optional<std::size_t>& found = choice.within[i];
    within.push_back({{"limit", error_limits_px[i]}, {"setting", found ? Json(settings[*found].name) : Json()}});
  }
  return {{"measure", measures[main_measure].key},
          {"near_best", near_best},
          {"time_noise", time_noise},
          {"recommended", settings[choice.recommended].name},
          {"fastest", settings[choice.fastest].name},
          {"most_accurate", settings[choice.most_accurate].name},
          {"as_accurate", settings[choice.as_accurate].name},
          {"within", within},
          {"budget_front", names_of(choice.budget_front, settings)}};
}

Json row_of(const std::string& scene, const std::string& path, const Setting& setting, const Outcome& outcome) {
  Json row = {{"scene", scene},
              {"path", path},
              {"setting", setting.name},
              {"series", setting.series},
              {"knob", setting.knob},
              {"budget", setting.refine.budget},
              {"triangles", outcome.triangles},
              {"ms", outcome.ms},
              {"refine_ms", outcome.refine_ms},
              {"occlusion_ms", outcome.occlusion_ms},
              {"draw_ms", outcome.draw_ms}};
  for (std::size_t m = 0; m < measures.size(); ++m) row[measures[m].key] = number(outcome.measured[m]);
  row["hash"] = fmt::format("{:016x}", outcome.hash);
  return row;
}

Json measures_json() {
  Json all = Json::array();
  for (const Measure& m : measures)
    all.push_back({{"key", m.key},
                   {"name", m.name},
                   {"unit", m.unit},
                   {"better", m.less_is_better ? "less" : "more"},
                   {"about", m.about}});
  return all;
}

Json knobs_json() {
  Json all = Json::array();
  for (const Knob& knob : knobs()) all.push_back({{"name", knob.name}, {"about", knob.about}});
  return all;
}

Json settings_json(const std::vector<Setting>& settings) {
  Json all = Json::array();
  for (const Setting& s : settings)
    all.push_back({{"name", s.name},
                   {"series", s.series},
                   {"knob", s.knob},
                   {"budget", s.refine.budget},
                   {"flags", s.flags},
                   {"offered", s.is_offered()}});
  return all;
}

Json scenes_json(const std::vector<SceneOutcomes>& scenes) {
  Json all = Json::array();
  for (const SceneOutcomes& s : scenes)
    all.push_back({{"name", s.scene},
                   {"path", s.path},
                   {"triangles", s.full_triangles},
                   {"frames", s.frames},
                   {"splits_or_hlod", tool::to_json(s.ways)}});
  return all;
}

Json fronts_json(const std::vector<Setting>& settings, const std::vector<Outcome>& over_all) {
  Json all = Json::object();
  for (std::size_t m = 0; m < measures.size(); ++m)
    all[measures[m].key] = names_of(pareto_front(costs(over_all, m)), settings);
  return all;
}

// Costs that are not to be chosen have no error that could be.
template <typename Keep>
std::vector<Cost> only(std::vector<Cost> costs, const std::vector<Setting>& settings, const Keep& keep) {
  for (std::size_t i = 0; i < costs.size(); ++i)
    if (!keep(settings[i])) costs[i].error = std::numeric_limits<double>::infinity();
  return costs;
}

std::size_t recommended(const std::vector<Cost>& in_budget) {
  const double enough = near_best * in_budget[pareto_front(in_budget).back()].error;
  const double in_time = time_noise * in_budget[*fastest_within(in_budget, enough)].ms;
  std::size_t i = 0;
  while (in_budget[i].error > enough || in_budget[i].ms > in_time) ++i;
  return i;
}

}  // namespace

Choice choose(const std::vector<Setting>& settings, const std::vector<Outcome>& over_all, std::size_t budget) {
  const std::vector<Cost> offered =
      only(costs(over_all, main_measure), settings, [](const Setting& s) { return s.is_offered(); });
  const std::vector<Cost> in_budget =
      only(offered, settings, [&](const Setting& s) { return s.refine.budget <= budget; });
  const std::vector<std::size_t> front = pareto_front(offered);
  if (front.empty()) throw Error({"bench_report", "", "has measured no error", "give it other scenes"});
  Choice choice;
  choice.recommended = recommended(in_budget);
  choice.fastest = front.front();
  choice.most_accurate = front.back();
  choice.as_accurate = *fastest_within(offered, offered[choice.recommended].error);
  for (const double limit : error_limits_px) choice.within.push_back(fastest_within(offered, limit));
  choice.budget_front = pareto_front(in_budget);
  return choice;
}

Table points_table(const std::vector<Setting>& settings, const std::vector<SceneOutcomes>& scenes,
                   const std::vector<Outcome>& over_all) {
  Table table{"points", "Every setting in every scene.", {}, {}};
  for (const char* key : {"scene", "path", "setting", "series", "knob", "budget", "triangles", "ms", "refine_ms",
                          "occlusion_ms", "draw_ms"})
    table.columns.push_back({key, key});
  for (const Measure& m : measures) table.columns.push_back({m.key, m.key, 3});
  table.columns.push_back({"hash", "hash"});
  for (std::size_t i = 0; i < settings.size(); ++i) table.add(row_of("all", "", settings[i], over_all[i]));
  for (const SceneOutcomes& scene : scenes)
    for (std::size_t i = 0; i < settings.size(); ++i)
      table.add(row_of(scene.scene, scene.path, settings[i], scene.outcomes[i]));
  return table;
}

Json to_json(const std::vector<Setting>& settings, const std::vector<SceneOutcomes>& scenes,
             const std::vector<Outcome>& over_all, const Choice& choice, const SweepOptions& options) {
  std::uint64_t hash = 0;
  for (const Outcome& outcome : over_all) hash = hash * 31 + outcome.hash;
  return {{"size", {options.size.width, options.size.height}},
          {"hidden_size", {options.hidden_size.width, options.hidden_size.height}},
          {"bursts", options.bursts},
          {"burst_frames", options.burst_frames},
          {"knob_budget", options.knob_budget},
          {"measures", measures_json()},
          {"knobs", knobs_json()},
          {"settings", settings_json(settings)},
          {"scenes", scenes_json(scenes)},
          {"fronts", fronts_json(settings, over_all)},
          {"choice", to_json(choice, settings)},
          {"hash", fmt::format("{:016x}", hash)}};
}

}  // namespace occlod::bench
