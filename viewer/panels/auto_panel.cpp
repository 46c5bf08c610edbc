// Explains the setting auto: what was on, what it cost and what it saved.
#include <fmt/format.h>

#include <string>

#include "controls.h"
#include "panels.h"

namespace occlod::viewer {
namespace {

// The first column is narrow, because values are long.
void draw_value(const char* name, const std::string& value) { draw_row(name, value, 0.3F); }

std::string shares_text(const HiddenShares& shares) {
  return fmt::format("{:.0f} % of nodes, {:.0f} % of stars", 100.0 * shares.visits_hidden, 100.0 * shares.stars_hidden);
}

void draw_looks(const EffectReport& report) {
  draw_value("Coarse", shares_text(report.ahead));
  draw_help_of_item("Share of the nodes and stars that refinement would visit which a coarse mesh hides");
  draw_value("Refined", report.back ? shares_text(*report.back) : "not measured yet");
  draw_help_of_item("The same for a refined mesh");
  draw_value("Measuring", fmt::format("{:.2f} ms in this view", report.look_ms));
}

void draw_forecasts(const Explanation& why) {
  if (!ImGui::BeginTable("forecasts", 4, ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_RowBg)) return;
  for (const char* name : {"Forecast", "ms", "error", "score"}) ImGui::TableSetupColumn(name);
  ImGui::TableHeadersRow();
  const EffectChoice& choice = why.report.choice;
  for (const EffectForecast& forecast : why.report.forecasts) {
    const bool chosen = forecast.backend == choice.backend;
    ImGui::TableNextColumn();
    ImGui::Text("%s%s", chosen ? "> " : "", forecast.backend ? "occlusion" : "none");
    for (const double value : {forecast.frame_ms, forecast.error, forecast.score()}) {
      ImGui::TableNextColumn();
      ImGui::Text("%.2f", value);
    }
  }
  ImGui::EndTable();
}

void draw_outcome(const Explanation& why, const RefineStats& stats) {
  const EffectReport& report = why.report;
  if (!report.choice.backend) {
    ImGui::TextWrapped("Occlusion culling is off: it would cost more than it saves.");
  } else {
    draw_value("Cost",
               fmt::format("{:.2f} ms, {} queries", stats.occlusion_ms, grouped(static_cast<double>(stats.queries))));
    draw_value("Forecast", fmt::format("{:.2f} ms a frame", report.chosen()->frame_ms));
    draw_value("Without", fmt::format("{:.2f} ms, {} triangles", report.same_error_without.ms,
                                      grouped(report.same_error_without.triangles)));
    draw_help_of_item("Estimate of what the same error would cost without occlusion culling");
  }
  if (report.held) ImGui::TextDisabled("Kept: any other choice would be only slightly better.");
}

// Costs per object are counts times the calibration.
void draw_object(const std::string& name, const ObjectEffects& effects, const ObjectEffectStats& stats,
                 const Explanation& why) {
  ImGui::TextUnformatted(name.c_str());
  draw_value("  cones", effects.cones ? "on" : "off");
  if (stats.cone_tests > 0)
    draw_value("", fmt::format("{} of {} culled, {:.3f} ms", stats.cone_culled, stats.cone_tests,
                               1e-6 * static_cast<double>(stats.cone_tests) * why.calibration.cone_ns));
  if (!why.report.choice.backend) return;
  const double query_ns = why.calibration.backends[*why.report.choice.backend].query_ns;
  draw_value("  queries", fmt::format("in {} of {} regions", effects.regions_on(), effect_region_count));
  draw_value("", fmt::format("{} of {} hidden, {:.3f} ms", stats.hidden(), stats.queries(),
                             1e-6 * static_cast<double>(stats.queries()) * query_ns));
}

}  // namespace

void draw_auto(Panels& panels) {
  const auto& frame = panels.session.frame();
  if (!frame || frame->sides.empty() || !frame->sides[0].explanation || !begin_section(panels, "Auto")) return;
  const Explanation& why = *frame->sides[0].explanation;
  const EffectReport& report = why.report;
  draw_value("On", report.choice.backend ? "occlusion" : "none");
  draw_outcome(why, frame->sides[0].refinement.stats);
  draw_looks(report);
  draw_forecasts(why);
  const Objects& objects = *frame->job.objects;
  for (std::size_t i = 0; i < report.objects.size() && i < objects.size(); ++i)
    draw_object(objects[i].name, report.choice.objects[i], report.objects[i], why);
}

}  // namespace occlod::viewer
