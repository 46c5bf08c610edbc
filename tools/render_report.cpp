#include "render_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "explanation.h"
#include "option_names.h"

namespace occlod::tool {
namespace {

Json objects_of(const RenderResult& result) {
  Json objects = Json::array();
  for (std::size_t i = 0; i < result.input.objects.size(); ++i) {
    const LoadedObject& object = result.input.objects[i];
    const RefinedObject& refined = result.measurement.refinement().objects[i];
    objects.push_back({{"source", object.source_name},
                       {"triangles", refined.triangles.size()},
                       {"base_triangles", object.hierarchy->base_triangle_count()},
                       {"full_triangles", object.hierarchy->input_triangle_count()},
                       {"splits", refined.splits.size()},
                       {"two_sided", object.two_sided},
                       {"object_to_world", to_json(object.object_to_world)}});
  }
  return objects;
}

}  // namespace

Json asked_of(const RenderInput& input, const RefineOptions& options, const RefineWay& way) {
  Json report;
  report["scene"] = input.name;
  if (input.path) report["path"] = input.path_name;
  report["method"] = name_of(options.method);
  report["mode"] = name_of(options.mode);
  report["occlusion"] = way.name();
  if (!way.gl().is_null()) report["gl"] = way.gl();
  report["budget"] = options.budget;
  report["tolerance_px"] = options.tolerance_px;
  if (way.chooser() != nullptr)  // its choice is reported for each view
    report["calibration"] = Json::parse(calibration_json(way.chooser()->calibration()));
  return report;
}

Json stats_of(const Measurement& measurement) {
  const RefineStats& stats = measurement.refinement().stats;
  const RenderTimes times = measurement.times();
  const std::size_t visible = measurement.visible_triangles();
  Json report;
  report["triangles"] = stats.triangles;
  report["visible_triangles"] = visible;
  report["visible_share"] =
      static_cast<double>(visible) / static_cast<double>(std::max<std::size_t>(stats.triangles, 1));
  report["splits"] = stats.splits;
  report["forced_splits"] = stats.forced_splits;
  report["forced_unseen_splits"] = stats.forced_unseen_splits;
  report["rejected_splits"] = stats.rejected_splits;
  report["visits"] = stats.visits;
  report["nodes"] = stats.nodes;
  report["culled_frustum"] = stats.culled_frustum;
  report["culled_backface"] = stats.culled_backface;
  report["culled_occlusion"] = stats.culled_occlusion;
  report["queries"] = stats.queries;
  report["queries_hidden"] = stats.queries_hidden;
  report["occluder_draws"] = stats.occluder_draws;
  report["readmitted"] = stats.readmitted;
  report["taken_back"] = stats.taken_back;
  report["refine_ms"] = times.refine_ms;
  report["occlusion_ms"] = times.occlusion_ms;
  report["draw_ms"] = times.draw_ms;
  report["max_quadric_error_px"] = stats.max_quadric_error_px;
  report["max_error_px"] = stats.max_error_px;
  report["hash"] = fmt::format("{:016x}", measurement.refinement().hash());
  return report;
}

Json following_asked_of(const RefineOptions& options) {
  return {{"max_changes", options.max_changes},
          {"time_limit_ms", options.time_limit_ms},
          {"geomorph_frames", options.geomorph_frames}};
}

Json changes_of(const RefineStats& stats) {
  return {{"new_splits", stats.new_splits},
          {"merged_splits", stats.merged_splits},
          {"changed_triangles", stats.changed_triangles},
          {"pending", stats.pending}};
}

Json report_of(const RenderResult& result) {
  Json report = asked_of(result.input, result.options, result.way);
  report.update(stats_of(result.measurement));
  if (result.way.chooser() != nullptr) report["auto"] = to_json(*result.way.chooser());
  report["wrongly_hidden_px"] = result.wrongly_hidden_px ? Json(*result.wrongly_hidden_px) : Json();
  if (result.distance) {
    report["depth_rms_px"] = result.distance->depth_rms_px;
    report["silhouette_mismatch"] = result.distance->silhouette_mismatch;
    report["psnr_y"] = result.distance->psnr_y;
    report["psnr_cb"] = result.distance->psnr_cb;
    report["psnr_cr"] = result.distance->psnr_cr;
    if (result.texture_slip_px) report["texture_slip_px"] = *result.texture_slip_px;
  }
  report["camera"] = to_json(result.input.camera);
  report["objects"] = objects_of(result);
  return report;
}

void print_report(const RenderResult& result) {
  Json report = report_of(result);
  const RefineStats& stats = result.measurement.refinement().stats;
  report["max_quadric_error_px"] =
      fmt::format("{:.6g}  largest error left in sight: quadric, about the RMS distance", stats.max_quadric_error_px);
  report["max_error_px"] =
      fmt::format("{:.6g}  its guaranteed bound, often many times the true error", stats.max_error_px);
  print_lines(report);
}

}  // namespace occlod::tool
