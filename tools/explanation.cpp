#include "explanation.h"

#include <fmt/format.h>

#include "standard_streams.h"

namespace occlod::tool {
namespace {

Json to_json(const HiddenShares& shares) {
  return {{"nodes", shares.visits},
          {"splits", shares.splits},
          {"nodes_hidden", shares.visits_hidden},
          {"splits_hidden", shares.splits_hidden},
          {"stars_hidden", shares.stars_hidden}};
}

std::string backend_of(const AutoRefiner& refiner, const std::optional<std::size_t>& index) {
  return index ? std::string(refiner.backend(*index).name()) : "none";
}

Json to_json(const AutoRefiner& refiner, const EffectForecast& forecast) {
  return {{"backend", backend_of(refiner, forecast.backend)},
          {"frame_ms", forecast.frame_ms},
          {"occlusion_ms", forecast.occlusion_ms},
          {"error", forecast.error},
          {"score", forecast.score()}};
}

Json to_json(const ObjectEffects& effects, const ObjectEffectStats& stats) {
  return {{"cones", effects.cones},          {"cone_tests", stats.cone_tests},  {"cone_culled", stats.cone_culled},
          {"occlusion", effects.occlusion},  {"regions", effects.regions_on()}, {"queries", stats.queries()},
          {"queries_hidden", stats.hidden()}};
}

void print_shares(const char* name, const HiddenShares& shares) {
  fmt::print("  {}: {:.0f} % of {} nodes hidden; of {} splits {:.0f} % with their subtree, {:.0f} % with their faces\n",
             name, 100.0 * shares.visits_hidden, shares.visits, shares.splits, 100.0 * shares.splits_hidden,
             100.0 * shares.stars_hidden);
}

void print_object(std::size_t i, const std::string& source, const AutoRefiner& refiner) {
  const EffectReport& report = refiner.report();
  const ObjectEffects& effects = report.choice.objects[i];
  const ObjectEffectStats& stats = report.objects[i];
  const Calibration& calibration = refiner.calibration();
  fmt::print("  object {} ({})\n", i, printable(source));
  fmt::print("    normal cones {}: {} of {} nodes culled, about {:.3f} ms\n", effects.cones ? "on" : "off",
             stats.cone_culled, stats.cone_tests, 1e-6 * static_cast<double>(stats.cone_tests) * calibration.cone_ns);
  if (!report.choice.backend) return;
  const double query_ns = calibration.backends[*report.choice.backend].query_ns;
  fmt::print("    occlusion {} in {} of {} regions: {} of {} queries answered hidden, about {:.3f} ms\n",
             effects.occlusion ? "on" : "off", effects.regions_on(), effect_region_count, stats.hidden(),
             stats.queries(), 1e-6 * static_cast<double>(stats.queries()) * query_ns);
}

}  // namespace

Json to_json(const AutoRefiner& refiner) {
  const EffectReport& report = refiner.report();
  Json json = {{"backend", backend_of(refiner, report.choice.backend)}};
  json["forecasts"] = Json::array();
  for (const EffectForecast& forecast : report.forecasts) json["forecasts"].push_back(to_json(refiner, forecast));
  json["ahead"] = to_json(report.ahead);
  json["back"] = report.back ? to_json(*report.back) : Json();
  json["looked_ahead"] = report.looked_ahead;
  json["looked_back"] = report.looked_back;
  json["held"] = report.held;
  json["look_ms"] = report.look_ms;
  json["same_error_without"] = {{"triangles", report.same_error_without.triangles},
                                {"frame_ms", report.same_error_without.ms}};
  json["objects"] = Json::array();
  for (std::size_t i = 0; i < report.objects.size(); ++i)
    json["objects"].push_back(to_json(report.choice.objects[i], report.objects[i]));
  return json;
}

void print_explanation(const AutoRefiner& refiner, const RefineStats& stats, const std::vector<LoadedObject>& objects) {
  const EffectReport& report = refiner.report();
  fmt::print("why this choice:\n");
  print_shares("look ahead at a coarse mesh", report.ahead);
  if (report.back) print_shares("look back at a refined mesh", *report.back);
  for (const EffectForecast& forecast : report.forecasts)
    fmt::print(
        "  {} {:<10} would take {:6.2f} ms, {:5.2f} of them for occlusion, with {:.2f} times the error: score "
        "{:.2f}\n",
        forecast.backend == report.choice.backend ? "*" : " ", backend_of(refiner, forecast.backend), forecast.frame_ms,
        forecast.occlusion_ms, forecast.error, forecast.score());
  if (report.held) fmt::print("  another choice scores better, but not by enough to change\n");
  fmt::print("  looking took {:.3f} ms in this view\n", report.look_ms);
  if (report.choice.backend)
    fmt::print(
        "  occlusion on ({}): took {:.2f} ms for {} occluders and {} queries; forecast {:.2f} ms for the frame,\n"
        "  against {:.2f} ms and {:.0f} triangles for the same error without occlusion\n",
        backend_of(refiner, report.choice.backend), stats.occlusion_ms, stats.occluder_draws, stats.queries,
        report.chosen()->frame_ms, report.same_error_without.ms, report.same_error_without.triangles);
  else
    fmt::print("  occlusion off: it would cost more than it saves\n");
  for (std::size_t i = 0; i < report.objects.size(); ++i) print_object(i, objects[i].source_name, refiner);
}

}  // namespace occlod::tool
