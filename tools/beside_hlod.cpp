#include "beside_hlod.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hlod_measurement.h"
#include "hlod_strategies.h"

namespace occlod::tool {
namespace {

constexpr std::size_t max_compared = 3;
constexpr double min_tolerance_px = 1.0 / 64, max_tolerance_px = 1024.0;
constexpr int tolerance_steps = 12;  // halvings of the 16 octaves between them, down to 0.3 %

hlod::TraverseOptions options_of(hlod::Strategy strategy, double tolerance_px) {
  hlod::TraverseOptions options;
  options.strategy = strategy;
  options.tolerance_px = tolerance_px;
  return options;
}

// With occlusion queries, lost pixels may cost more error than the splits have, however fine the rest is.
bool leaves_more_error(const WayCost& way, const WayCost& splits) { return way.depth_rms_px > splits.depth_rms_px; }

std::string text_of(const PaysWhere& where) {
  if (where.below_ns == PaysWhere::infinity) return "pays whatever a triangle costs";
  if (where.below_ns > 0.0) return fmt::format("pays where a triangle costs less than {:.0f} ns", where.below_ns);
  if (where.above_ns < PaysWhere::infinity)
    return fmt::format("pays where a triangle costs more than {:.0f} ns", where.above_ns);
  return "does not pay";
}

// JSON has no number for "infinite". The bounds are null if the error is larger.
Json as_hlod(const WayCost& way, const WayCost& splits) {
  const auto bound = [](double ns) { return std::isinf(ns) ? Json("infinite") : Json(ns); };
  const PaysWhere where = pays_where(way, splits);
  const bool is_equal = !leaves_more_error(way, splits);
  return {{"tolerance_px", way.tolerance_px},
          {"queries", way.queries},
          {"pays_below_ns", is_equal ? bound(where.below_ns) : Json()},
          {"pays_above_ns", is_equal ? bound(where.above_ns) : Json()}};
}

std::string verdict_on(const WayCost& way, const WayCost& splits) {
  if (leaves_more_error(way, splits)) return fmt::format("leaves {:.3f} px at any tolerance", way.depth_rms_px);
  return text_of(pays_where(way, splits));
}

}  // namespace

PaysWhere pays_where(const WayCost& way, const WayCost& other) {
  const double more_triangles = way.triangles - other.triangles, less_ms = other.ms - way.ms;
  if (more_triangles <= 0.0 && less_ms >= 0.0) return {PaysWhere::infinity, 0.0};
  if (more_triangles >= 0.0 && less_ms <= 0.0) return {};
  const double ns = 1e6 * less_ms / more_triangles;
  return less_ms > 0.0 ? PaysWhere{ns, PaysWhere::infinity} : PaysWhere{0.0, ns};
}

BesideHlod::BesideHlod(const std::vector<LoadedObject>& objects, int views)
    : objects_(objects), view_count_(static_cast<std::size_t>(views)) {}

bool BesideHlod::is_compared(std::size_t view) const {
  const auto so_far = [this](std::size_t views) { return views * std::min(max_compared, view_count_) / view_count_; };
  return so_far(view + 1) > so_far(view);
}

void BesideHlod::add(const View& view, const Measurement& measurement) {
  const RenderTimes times = measurement.times();
  splits_.triangles += static_cast<double>(measurement.refinement().stats.triangles);
  splits_.ms += times.refine_ms + times.occlusion_ms;
  splits_.draw_ms += times.draw_ms;
  views_.push_back(view);
  if (!is_compared(views_.size() - 1)) return;
  const Compared& compared = compared_.emplace_back(objects_, view);
  const double rms_px = compared.full.distance_to(measurement.items(), measurement.objects()).depth_rms_px;
  splits_.depth_rms_px += rms_px * rms_px;
}

WayCost BesideHlod::splits() const {
  const auto views = static_cast<double>(views_.size());
  return {.name = "splits",
          .triangles = splits_.triangles / views,
          .ms = splits_.ms / views,
          .draw_ms = splits_.draw_ms / views,
          .depth_rms_px = std::sqrt(splits_.depth_rms_px / static_cast<double>(compared_.size()))};
}

double BesideHlod::depth_rms_px(std::span<const hlod::PlacedHlod> placed, hlod::Strategy strategy,
                                double tolerance_px) const {
  double sum = 0.0;
  for (const Compared& compared : compared_) {
    HlodMeasurement measurement(placed, options_of(strategy, tolerance_px));
    measurement.repeat(compared.view);
    if (strategy != hlod::Strategy::vfc) measurement.repeat(compared.view);  // like a frame that follows another
    const double rms_px = compared.full.distance_to(measurement.items(), measurement.objects()).depth_rms_px;
    sum += rms_px * rms_px;
  }
  return std::sqrt(sum / static_cast<double>(compared_.size()));
}

WayCost BesideHlod::hlod(std::span<const hlod::PlacedHlod> placed, hlod::Strategy strategy) const {
  const double max_px = splits().depth_rms_px;
  double keeps = std::log2(min_tolerance_px), exceeds = std::log2(max_tolerance_px);
  for (int step = 0; step < tolerance_steps; ++step) {
    const double middle = (keeps + exceeds) / 2.0;
    (depth_rms_px(placed, strategy, std::exp2(middle)) <= max_px ? keeps : exceeds) = middle;
  }
  WayCost cost{.name = fmt::format("HLOD, {}", name_of(strategy)), .tolerance_px = std::exp2(keeps)};
  cost.depth_rms_px = depth_rms_px(placed, strategy, cost.tolerance_px);
  HlodMeasurement measurement(placed, options_of(strategy, cost.tolerance_px));
  const auto views = static_cast<double>(views_.size());
  for (const View& view : views_) {
    measurement.begin();
    measurement.repeat(view);
    cost.triangles += static_cast<double>(measurement.stats().drawn_triangles) / views;
    cost.queries += static_cast<double>(measurement.stats().queries) / views;
    cost.ms += measurement.times().traverse_ms / views;
    cost.draw_ms += measurement.times().draw_ms / views;
  }
  return cost;
}

std::vector<WayCost> costs_of_ways(const BesideHlod& beside, std::span<const hlod::PlacedHlod> placed) {
  return {beside.splits(), beside.hlod(placed, hlod::Strategy::vfc), beside.hlod(placed, hlod::Strategy::coh)};
}

Json to_json(const std::vector<WayCost>& ways) {
  Json all = Json::array();
  for (const WayCost& way : ways) {
    Json one = {{"way", way.name},
                {"triangles", way.triangles},
                {"ms", way.ms},
                {"draw_ms", way.draw_ms},
                {"depth_rms_px", way.depth_rms_px}};
    if (&way != &ways.front()) one.update(as_hlod(way, ways.front()));
    all.push_back(std::move(one));
  }
  return all;
}

void print_ways(const std::vector<WayCost>& ways) {
  fmt::print("splits or an HLOD, with no larger error than the splits leave ({:.3f} px RMS of depth):\n",
             ways.front().depth_rms_px);
  fmt::print("  {:<10}  {:>9}  {:>8}  {:>12}  {:>7}\n", "way", "triangles", "ms", "tolerance px", "queries");
  for (const WayCost& way : ways) {
    fmt::print("  {:<10}  {:>9.0f}  {:>8.3f}", way.name, way.triangles, way.ms);
    if (&way != &ways.front())
      fmt::print("  {:>12.2f}  {:>7.0f}  {}", way.tolerance_px, way.queries, verdict_on(way, ways.front()));
    fmt::print("\n");
  }
  fmt::print("  drawing takes {:.0f} ns a triangle of the splits by this program's rasteriser\n",
             ways.front().triangle_ns());
}

}  // namespace occlod::tool
