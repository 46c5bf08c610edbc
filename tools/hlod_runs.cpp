#include "hlod_runs.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "chosen_views.h"
#include "hlod/draw/trial.h"
#include "hlod_cache.h"
#include "hlod_strategies.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

Json to_json(const hlod::FrameStats& stats) {
  return {{"drawn_nodes", stats.drawn_nodes},
          {"drawn_patches", stats.drawn_patches},
          {"drawn_triangles", stats.drawn_triangles},
          {"cut_nodes", stats.cut_nodes},
          {"recut_nodes", stats.recut_nodes},
          {"rarn", stats.rarn},
          {"delayed", stats.delayed},
          {"blocked", stats.blocked},
          {"visits", stats.visits},
          {"queries", stats.queries},
          {"wasted_queries", stats.wasted_queries},
          {"hidden_nodes", stats.hidden_nodes},
          {"waiting_nodes", stats.waiting_nodes},
          {"largest_sse_px", stats.largest_sse_px}};
}

Json to_json(const hlod::FrameTimes& times) {
  return {{"frame_ms", times.frame_ms},
          {"cpu_ms", times.cpu_ms},
          {"gpu_ms", times.gpu_ms},
          {"stall_ms", times.stall_ms},
          {"starve_ms", times.starve_ms}};
}

// Describes for `automatic` which strategy drew the frame, and the predicted times of those that were tried.
Json choice_to_json(const hlod::Frame& frame) {
  Json json = {{"drawn_by", name_of(frame.strategy)}};
  for (const hlod::StrategyForecast& forecast : frame.forecasts)
    json[fmt::format("forecast_{}_ms", name_of(forecast.strategy))] = forecast.frame_ms;
  return json;
}

Json to_json(const HlodDistance& distance) {
  return {{"depth_rms_px", distance.to_full.depth_rms_px},
          {"silhouette_mismatch", distance.to_full.silhouette_mismatch},
          {"psnr_y", distance.to_full.psnr_y},
          {"psnr_cb", distance.to_full.psnr_cb},
          {"psnr_cr", distance.to_full.psnr_cr},
          {"unculled_psnr_y", distance.to_unculled.psnr_y},
          {"unculled_psnr_cb", distance.to_unculled.psnr_cb},
          {"unculled_psnr_cr", distance.to_unculled.psnr_cr},
          {"wrongly_hidden_px", distance.wrongly_hidden_px},
          {"crack_px", distance.crack_px},
          {"popping_px", distance.popping.largest_px},
          {"popping_rms_px", distance.popping.rms_px},
          {"depth_complexity", distance.depth_complexity}};
}

// Adds up mean and standard deviation of a column over the frames that have it. Equal pictures have no finite
// signal-to-noise ratio and are left out.
struct Column {
  std::vector<double> values;

  [[nodiscard]] double sum() const { return std::accumulate(values.begin(), values.end(), 0.0); }
  [[nodiscard]] double mean() const { return values.empty() ? 0.0 : sum() / static_cast<double>(values.size()); }
  [[nodiscard]] double deviation() const {
    double sum = 0.0;
    for (const double value : values) sum += (value - mean()) * (value - mean());
    return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
  }
  [[nodiscard]] double largest() const {
    return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
  }
};

Column column_of(const std::vector<Json>& rows, const std::string& key) {
  Column column;
  for (const Json& row : rows)
    if (const auto found = row.find(key); found != row.end() && std::isfinite(found->get<double>()))
      column.values.push_back(found->get<double>());
  return column;
}

std::string hash_of(const std::vector<Json>& rows) {
  std::string hashes;
  for (const Json& row : rows) hashes += row["hash"].get<std::string>();
  return fmt::format("{:016x}", XXH3_64bits(hashes.data(), hashes.size()));
}

// Returns a value that this share of the values, at least one, does not exceed.
double quantile(std::vector<double> values, double share) {
  const auto place = std::lround(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

// Returns whether the maximum is reported, and is_told_whole() whether the sum is; for other keys the average is.
bool is_told_largest(const std::string& key) {
  return key == "largest_sse_px" || key == "resident_bytes" || key == "resident_nodes" || key == "failed";
}
bool is_told_whole(const std::string& key) {
  return key == "loads" || key == "bytes_loaded" || key == "reads" || key == "evictions";
}

bool is_ratio(const std::string& key) { return key.find("psnr") != std::string::npos; }

}  // namespace

HlodRuns::HlodRuns(const HlodScene& scene, std::vector<HlodRun> runs, int compared_frames)
    : scene_(scene), compared_frames_(std::min(compared_frames, scene.path.frames)) {
  if (compared_frames_ > 0) reference_.emplace(scene.placed, runs.front().options, runs.front().trial);
  for (const HlodRun& run : runs) {
    states_.push_back({run, hlod::Traverser(scene.placed), nullptr, {}, {}});
    if (run.trial != nullptr) states_.back().traverser.set_trial(*run.trial);
  }
}

bool HlodRuns::is_compared(int frame) const { return tool::is_compared(frame, compared_frames_, scene_.path.frames); }

void HlodRuns::draw(int frame) {
  const View view(camera_at(scene_.path, frame));
  if (is_compared(frame)) reference_->set_view(view, View(camera_at(scene_.path, std::max(frame - 1, 0))));
  for (State& state : states_) draw(state, frame, view);
}

void HlodRuns::draw(State& state, int frame, const View& view) {
  const std::optional<hlod::StoreStats> stores = store_stats(scene_.placed);
  const Stopwatch watch;
  state.frame = &state.traverser.draw_frame(view, *state.run.device, state.run.options);
  const double wall_ms = watch.milliseconds();
  Front before = std::exchange(state.front, front_of(*state.frame));
  if (frame == 0) before = state.front;
  Json row = {{"frame", frame}};
  row.update(to_json(state.frame->stats));
  row.update(to_json(state.frame->times));
  if (stores) {  // only these report wall times: all other values are equal in every run
    row["wall_ms"] = wall_ms;
    row.update(to_json(*store_stats(scene_.placed), *stores));
  }
  row["hash"] = fmt::format("{:016x}", state.frame->front_hash);
  if (state.run.options.strategy == hlod::Strategy::automatic) row.update(choice_to_json(*state.frame));
  if (is_compared(frame)) row.update(to_json(reference_->compare(state.front, before)));
  state.rows.push_back(std::move(row));
}

Json HlodRuns::summary(std::size_t run) const {
  const std::vector<Json>& rows = states_[run].rows;
  Json keys;  // of all columns, those of compared frames last
  for (const Json& row : rows) keys.update(row);
  Json result = {{"frames", rows.size()}, {"compared_frames", compared_frames_}};
  for (const auto& [key, value] : keys.items()) {
    if (key == "frame" || key == "hash" || key == "drawn_by") continue;
    const Column column = column_of(rows, key);
    const double told = is_told_largest(key) ? column.largest() : is_told_whole(key) ? column.sum() : column.mean();
    result[key] = column.values.empty() ? Json() : Json(told);
    if (is_ratio(key)) result[key + "_deviation"] = column.values.empty() ? Json() : Json(column.deviation());
    if (key == "popping_px" || key == "frame_ms") result["largest_" + key] = column.largest();
  }
  if (compared_frames_ > 0)
    result["equal_pictures"] =
        static_cast<std::size_t>(compared_frames_) - column_of(rows, "unculled_psnr_y").values.size();
  if (const std::vector<double> wall_ms = column_of(rows, "wall_ms").values; !wall_ms.empty()) {
    result["p50_wall_ms"] = quantile(wall_ms, 0.50);
    result["p99_wall_ms"] = quantile(wall_ms, 0.99);
  }
  const double frame_ms = result["frame_ms"].get<double>();
  result["fps"] = frame_ms > 0.0 ? 1e3 / frame_ms : 0.0;
  result["hash"] = hash_of(rows);
  return result;
}

}  // namespace occlod::tool
