// Lists the numbers that scripts check, by name.
#include <glm/geometric.hpp>
#include <map>
#include <string>

#include "session.h"

namespace occlod::viewer {
namespace {

void add_figures(std::map<std::string, double>& figures, const hlod::StoreStats& cache) {
  figures["cache_budget_bytes"] = static_cast<double>(cache.budget_bytes);
  figures["cache_resident_bytes"] = static_cast<double>(cache.resident_bytes);
  figures["cache_resident_nodes"] = static_cast<double>(cache.resident_nodes);
  figures["cache_loading_bytes"] = static_cast<double>(cache.loading_bytes);
  figures["cache_missing"] = static_cast<double>(cache.missing);
  figures["cache_loads"] = static_cast<double>(cache.loads);
  figures["cache_evictions"] = static_cast<double>(cache.evictions);
  figures["cache_failed"] = static_cast<double>(cache.failed);
}

void add_figures(std::map<std::string, double>& figures, const RefinedFrame& frame) {
  if (frame.cache) add_figures(figures, *frame.cache);
  const hlod::Frame& front = frame.hlod_sides[0].front->frame;
  const hlod::FrameStats& stats = front.stats;
  figures["triangles"] = static_cast<double>(stats.drawn_triangles);
  figures["queries"] = static_cast<double>(stats.queries);
  figures["queries_hidden"] = static_cast<double>(stats.hidden_nodes);
  figures["max_error_px"] = stats.largest_sse_px;
  figures["tolerance_px"] = frame.hlod_sides[0].tolerance_px;
  figures["drawn_nodes"] = static_cast<double>(stats.drawn_nodes);
  figures["drawn_patches"] = static_cast<double>(stats.drawn_patches);
  figures["cut_nodes"] = static_cast<double>(stats.cut_nodes);
  figures["rarn"] = static_cast<double>(stats.rarn);
  figures["delayed"] = static_cast<double>(stats.delayed);
  figures["blocked"] = static_cast<double>(stats.blocked);
  figures["wasted_queries"] = static_cast<double>(stats.wasted_queries);
  figures["frame_ms"] = front.times.frame_ms;
  figures["stall_ms"] = front.times.stall_ms;
  if (frame.hlod_sides.size() < 2) return;
  const hlod::Frame& other = frame.hlod_sides[1].front->frame;
  figures["other_drawn_nodes"] = static_cast<double>(other.stats.drawn_nodes);
  figures["other_triangles"] = static_cast<double>(other.stats.drawn_triangles);
  figures["other_frame_ms"] = other.times.frame_ms;
}

void add_figures(std::map<std::string, double>& figures, const CellsFrame& frame) {
  const WalkedFrame& walked = frame.walked;
  figures["triangles"] = static_cast<double>(walked.drawn_triangles);
  figures["max_error_px"] = walked.error_px;
  figures["cells"] = static_cast<double>(frame.cells->leaves.size());
  figures["cell"] = static_cast<double>(walked.cell);
  figures["shown_cell"] = static_cast<double>(walked.shown);
  figures["outside"] = walked.outside ? 1.0 : 0.0;
  figures["promised"] = frame.unpromised.empty() ? 1.0 : 0.0;
  figures["left_out"] = static_cast<double>(frame.left_out);
  figures["walked_frames"] = static_cast<double>(frame.frames);
  figures["late_frames"] = static_cast<double>(frame.late);
  figures["missing_frames"] = static_cast<double>(frame.missing);
  figures["crossings"] = static_cast<double>(frame.crossings);
  figures["cell_loads"] = static_cast<double>(frame.loads);
  figures["bytes_read"] = static_cast<double>(frame.bytes_read);
  figures["resident_bytes"] = static_cast<double>(walked.resident_bytes);
}

}  // namespace

std::map<std::string, double> Session::figures() const {
  std::map<std::string, double> figures = {{"objects", static_cast<double>(state_.objects->size())},
                                           {"bookmarks", static_cast<double>(state_.bookmarks.size())},
                                           {"paths", static_cast<double>(state_.paths.size())},
                                           {"pictures", static_cast<double>(pictures_)},
                                           {"errors", static_cast<double>(state_.errors)},
                                           {"picked", state_.pick ? 1.0 : 0.0},
                                           {"memory_mb", resident_memory_mb()}};
  if (state_.measured.size() == 2) figures["distance"] = glm::distance(state_.measured[0], state_.measured[1]);
  if (frame_ && !frame_->hlod_sides.empty()) add_figures(figures, *frame_);
  if (frame_ && frame_->cells) add_figures(figures, *frame_->cells);
  if (!frame_ || frame_->sides.empty()) return figures;
  const RefineStats& stats = frame_->sides[0].refinement.stats;
  if (const auto& visible = frame_->sides[0].visible_triangles) {
    figures["visible_triangles"] = static_cast<double>(*visible);
    figures["visible_share"] = static_cast<double>(*visible) / static_cast<double>(stats.triangles);
  }
  if (frame_->cells) return figures;
  figures["budget"] = static_cast<double>(stats.budget);
  figures["triangles"] = static_cast<double>(stats.triangles);
  figures["splits"] = static_cast<double>(stats.splits);
  figures["forced_splits"] = static_cast<double>(stats.forced_splits);
  figures["queries"] = static_cast<double>(stats.queries);
  figures["queries_hidden"] = static_cast<double>(stats.queries_hidden);
  figures["occluder_draws"] = static_cast<double>(stats.occluder_draws);
  figures["max_error_px"] = stats.max_error_px;
  figures["max_quadric_error_px"] = stats.max_quadric_error_px;
  figures["new_splits"] = static_cast<double>(stats.new_splits);
  figures["merged_splits"] = static_cast<double>(stats.merged_splits);
  figures["changed_triangles"] = static_cast<double>(stats.changed_triangles);
  figures["pending"] = stats.pending ? 1.0 : 0.0;
  figures["refine_ms"] = stats.refine_ms;
  figures["occlusion_ms"] = stats.occlusion_ms;
  if (const auto& why = frame_->sides[0].explanation) {
    figures["auto_asks"] = why->report.choice.backend ? 1.0 : 0.0;
    figures["auto_held"] = why->report.held ? 1.0 : 0.0;
    figures["look_ms"] = why->report.look_ms;
    figures["same_error_triangles"] = why->report.same_error_without.triangles;
    figures["same_error_ms"] = why->report.same_error_without.ms;
  }
  if (frame_->sides.size() < 2) return figures;
  const RefinedSide& beside = frame_->sides[1];
  if (frame_->job.beside == Beside::other)
    figures["visible_triangles_without"] = static_cast<double>(beside.visible_triangles.value_or(0));
  else
    figures["full_triangles"] = static_cast<double>(beside.refinement.stats.triangles);
  if (!beside.difference) return figures;
  figures["depth_rms_px"] = beside.difference->rms_px;
  figures["silhouette_mismatch"] = beside.difference->silhouette_mismatch;
  return figures;
}

}  // namespace occlod::viewer
