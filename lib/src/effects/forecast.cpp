#include "forecast.h"

#include <algorithm>
#include <cmath>

#include "queries/occluder_steps.h"

namespace occlod {
namespace {

constexpr double most_hidden = 0.95;         // limits the shares found by small samples
constexpr double fragments_per_pixel = 2.0;  // Guthe, sec. 3.2.1

bool is_renewed(OcclusionEffort effort) {
  return effort == OcclusionEffort::renewed_subtrees || effort == OcclusionEffort::renewed_stars;
}
bool asks_stars(OcclusionEffort effort) {
  return effort == OcclusionEffort::stars || effort == OcclusionEffort::renewed_stars;
}

struct OccluderCounts {
  double draws = 0.0;
  double triangles = 0.0;  // of all draws
};

OccluderCounts occluders_of(Way way, OcclusionEffort effort, double triangles) {
  if (way == Way::going_on) return {1.0, triangles};
  if (!is_renewed(effort)) return {1.0, 2.0 * single_occluder_splits(static_cast<std::size_t>(triangles))};
  OccluderCounts counts;
  double at = OccluderSteps::first(triangles);
  while (at < triangles) {
    counts.draws += 1.0;
    counts.triangles += at;
    at *= OccluderSteps::factor;
  }
  return counts;
}

// Counted with this effort if known, else with another, else estimated from the shares: visits saved on hidden surface
// are spent elsewhere, where the freed triangles go.
FrameCounts counts_with(OcclusionEffort effort, const Prospect& prospect, const HiddenShares& shares) {
  if (const auto& known = prospect.known[static_cast<std::size_t>(effort)]) return *known;
  const auto other = std::find_if(prospect.known.begin() + 1, prospect.known.end(),
                                  [](const auto& known) { return known.has_value(); });
  if (other != prospect.known.end()) return **other;
  FrameCounts with = prospect.counts;
  with.visits *= (1.0 - shares.visits_hidden) / (1.0 - std::min(shares.splits_hidden, most_hidden));
  return with;
}

const HiddenShares& shares_for(OcclusionEffort effort, const Prospect& prospect) {
  return is_renewed(effort) ? prospect.back : prospect.ahead;
}

// The share of splits that an effort frees.
double hidden_with(OcclusionEffort effort, const HiddenShares& shares) {
  return std::min(asks_stars(effort) ? shares.stars_hidden : shares.splits_hidden, most_hidden);
}

// b of error_with().
double error_exponent(double growth) {
  constexpr double least_growth = 0.1;
  return std::log(2.0) / std::log1p(std::clamp(growth, least_growth, 1.0));
}

EffortForecast forecast(const Calibration& calibration, std::size_t backend, OcclusionEffort effort,
                        const Prospect& prospect) {
  const BackendCosts& costs = calibration.backends[backend];
  const FrameCounts& counts = prospect.counts;
  const HiddenShares& shares = shares_for(effort, prospect);
  const OccluderCounts occluders = occluders_of(prospect.way, effort, counts.triangles);
  const double queries = prospect.rates[static_cast<std::size_t>(effort)] * counts.triangles;
  EffortForecast result{effort, backend, 0.0, 0.0, 1.0};
  result.occlusion_ms = 1e-6 * (occluders.triangles * costs.occluder_triangle_ns +
                                occluders.draws * (counts.pixels * costs.occluder_pixel_ns + costs.latency_ns) +
                                queries * costs.query_ns);
  const FrameCounts with = counts_with(effort, prospect, shares);
  result.frame_ms = frame_ms_without(calibration, with) + result.occlusion_ms;
  result.error = error_with(hidden_with(effort, shares), shares.growth);
  return result;
}

}  // namespace

double frame_ms_without(const Calibration& calibration, const FrameCounts& counts) {
  const double visit_ns =
      calibration.visit_ns + counts.far_share * (calibration.far_visit_ns - calibration.visit_ns) + calibration.cone_ns;
  return 1e-6 * (counts.visits * visit_ns + counts.splits * calibration.split_ns +
                 counts.kept_splits * calibration.kept_split_ns + counts.triangles * calibration.triangle_ns +
                 fragments_per_pixel * counts.pixels * calibration.fragment_ns);
}

// What depends on the number of triangles grows with it; pixels do not.
FrameForecast same_error_without(const Calibration& calibration, const Prospect& prospect, const EffortForecast& chosen,
                                 std::size_t full_triangles) {
  FrameCounts counts = prospect.counts;
  const double most = std::max(static_cast<double>(full_triangles) / counts.triangles, 1.0);
  const HiddenShares& shares = shares_for(chosen.effort, prospect);
  const double factor = std::clamp(std::pow(chosen.error, -1.0 / error_exponent(shares.growth)), 1.0, most);
  counts.triangles *= factor;
  counts.splits *= factor;
  counts.kept_splits *= factor;
  counts.visits *= factor;
  return {counts.triangles, frame_ms_without(calibration, counts)};
}

double error_with(double hidden, double growth) {
  constexpr double picture_exponent = 0.4;
  constexpr double least_error = 0.05;  // limits the gain claimed by small samples
  return std::max(least_error,
                  std::pow(1.0 - std::min(hidden, most_hidden), picture_exponent * error_exponent(growth)));
}

std::vector<EffortForecast> forecasts(const Calibration& calibration, const Prospect& prospect) {
  std::vector<EffortForecast> all;
  all.push_back({OcclusionEffort::none, {}, frame_ms_without(calibration, prospect.counts), 0.0, 1.0});
  for (std::size_t backend = 0; backend < calibration.backends.size(); ++backend)
    for (std::size_t i = 1; i < occlusion_effort_count; ++i) {
      const auto effort = static_cast<OcclusionEffort>(i);
      if (prospect.way == Way::from_scratch || effort == OcclusionEffort::renewed_stars)
        all.push_back(forecast(calibration, backend, effort, prospect));
    }
  return all;
}

// Errors fall with one over the number of triangles: a node whose error is n times the final level has about n splits
// below it.
double splits_freed(const ObjectEffectStats::Region& region, double level_px) {
  constexpr double least_level_px = 0.1;
  return region.hidden_stars + static_cast<double>(region.hidden_subtrees_px) / std::max(level_px, least_level_px);
}

double split_worth_ns(const Calibration& calibration, const FrameCounts& counts) {
  return 1e6 * frame_ms_without(calibration, counts) / std::max({counts.splits, counts.kept_splits, 1.0});
}

QueryRates usual_query_rates(Way way) noexcept {
  if (way == Way::going_on) return {0.0, 0.0, 0.0, 0.0, 0.1};
  return {0.0, 0.68, 0.71, 0.92, 0.95};
}

// A node, its star and the positions that it names are some 250 bytes: half of the visits are far where there are four
// times as many as fill the caches of the machines that this was fitted on.
double far_share(std::size_t splits) noexcept {
  constexpr double half_far = 400'000.0;
  const auto count = static_cast<double>(splits);
  return count / (count + half_far);
}

FrameCounts usual_counts(Way way, std::size_t budget, const View& view, double far_share) noexcept {
  const auto triangles = static_cast<double>(budget);
  const double pixels = static_cast<double>(view.width()) * view.height();
  if (way == Way::going_on) return {triangles, 0.02 * triangles, 0.5 * triangles, 0.012 * triangles, pixels, far_share};
  return {triangles, 0.5 * triangles, 0.0, 1.6 * triangles, pixels, far_share};
}

std::uint32_t single_occluder_splits(std::size_t budget) noexcept {
  return static_cast<std::uint32_t>(std::clamp<std::size_t>(budget / 32, 64, 1U << 20U));
}

}  // namespace occlod
