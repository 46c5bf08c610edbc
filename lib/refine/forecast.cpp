#include "refine/forecast.h"

#include <algorithm>
#include <cmath>

#include "occlod/auto_refiner.h"
#include "refine/occluder.h"
#include "refine/tuning.h"

namespace occlod {
namespace {

constexpr double max_hidden = 0.95;  // limits the shares found by small samples

bool is_renewed(OcclusionEffort effort) {
  return effort == OcclusionEffort::renewed_subtrees || effort == OcclusionEffort::renewed_stars;
}
bool asks_stars(OcclusionEffort effort) {
  return effort == OcclusionEffort::stars || effort == OcclusionEffort::renewed_stars;
}

struct OccluderCounts {
  double draws = 0.0;
  double triangles = 0.0;  // triangles that face the eye, summed over draws
  double layers = 0.0;     // fragments per pixel, summed over draws
};

// Returns the fragments per pixel of an occluder with this many triangles. Looks have counted those of a coarse mesh
// and of one that uses the budget; each doubling in between adds as much.
double layers_of(double triangles, const Prospect& prospect) {
  const double coarse = prospect.ahead.coverage.front_layers, fine = prospect.back.coverage.front_layers;
  const double doublings = std::log2(std::max(prospect.counts.triangles / coarse_triangles, 2.0));
  const double part = std::clamp(std::log2(triangles / coarse_triangles) / doublings, 0.0, 1.0);
  return std::lerp(coarse, fine, part);
}

OccluderCounts occluders_of(const Prospect& prospect, OcclusionEffort effort) {
  const double triangles = prospect.counts.triangles;
  OccluderCounts counts;
  const auto draw = [&](double of) {
    counts.draws += 1.0;
    counts.triangles += of * prospect.back.coverage.front_share;
    counts.layers += layers_of(of, prospect);
  };
  if (prospect.way == Way::going_on) {
    draw(triangles);
  } else if (!is_renewed(effort)) {
    draw(2.0 * single_occluder_splits(static_cast<std::size_t>(triangles)));
  } else {
    for (double at = OccluderSteps::first(triangles); at < triangles; at *= OccluderSteps::factor) draw(at);
  }
  return counts;
}

// Returns the factor by which occlusion changes the visits. Visits saved on hidden surface are spent elsewhere, where
// the freed triangles go. The factor has a lower bound, because refinement without occlusion does not visit all hidden
// nodes either.
double visits_factor(const HiddenShares& shares) {
  constexpr double least = 0.4;
  return std::clamp((1.0 - shares.visits_hidden) / (1.0 - std::min(shares.splits_hidden, max_hidden)), least, 1.0);
}

// Returns the counts measured with this effort if known, else with another, else an estimate from the shares.
FrameCounts counts_with(OcclusionEffort effort, const Prospect& prospect, const HiddenShares& shares) {
  if (const auto& known = prospect.known[static_cast<std::size_t>(effort)]) return *known;
  const auto other = std::find_if(prospect.known.begin() + 1, prospect.known.end(),
                                  [](const auto& known) { return known.has_value(); });
  if (other != prospect.known.end()) return **other;
  FrameCounts with = prospect.counts;
  with.visits *= visits_factor(shares);
  return with;
}

const HiddenShares& shares_for(OcclusionEffort effort, const Prospect& prospect) {
  return is_renewed(effort) ? prospect.back : prospect.ahead;
}

// Returns the share of splits that an effort frees. From frame to frame only star queries test applied splits again:
// without them what becomes hidden stays, and the error falls by 0.4 times as many octaves (0.2 to 0.45 on the shipped
// scenes).
double hidden_with(OcclusionEffort effort, const Prospect& prospect, const HiddenShares& shares) {
  constexpr double found_anew = 0.4;
  if (asks_stars(effort)) return std::min(shares.stars_hidden, max_hidden);
  const double hidden = std::min(shares.splits_hidden, max_hidden);
  return prospect.way == Way::going_on ? 1.0 - std::pow(1.0 - hidden, found_anew) : hidden;
}

EffortForecast forecast(const Calibration& calibration, std::size_t backend, OcclusionEffort effort,
                        const Prospect& prospect) {
  const BackendCosts& costs = calibration.backends[backend];
  const FrameCounts& counts = prospect.counts;
  const HiddenShares& shares = shares_for(effort, prospect);
  const OccluderCounts occluders = occluders_of(prospect, effort);
  const double queries = prospect.rates[static_cast<std::size_t>(effort)] * counts.triangles;
  EffortForecast result{effort, backend, 0.0, 0.0, 1.0};
  result.occlusion_ms = 1e-6 * (occluders.triangles * costs.occluder_triangle_ns +
                                occluders.layers * counts.pixels * costs.occluder_fragment_ns +
                                occluders.draws * (counts.pixels * costs.occluder_pixel_ns + costs.latency_ns) +
                                queries * costs.query_ns);
  const FrameCounts with = counts_with(effort, prospect, shares);
  result.frame_ms = frame_ms_without(calibration, with) + result.occlusion_ms;
  const double error = error_with(hidden_with(effort, prospect, shares), shares.finer);
  result.error =
      std::hypot(error * prospect.error_px, unseen_error_px) / std::hypot(prospect.error_px, unseen_error_px);
  return result;
}

}  // namespace

double frame_ms_without(const Calibration& calibration, const FrameCounts& counts) {
  const double visit_ns =
      calibration.visit_ns + counts.far_share * (calibration.far_visit_ns - calibration.visit_ns) + calibration.cone_ns;
  return 1e-6 * (counts.visits * visit_ns + counts.splits * calibration.split_ns +
                 counts.kept_splits * calibration.kept_split_ns + counts.triangles * calibration.triangle_ns +
                 std::max(counts.layers, 1.0) * counts.pixels * calibration.fragment_ns);
}

FrameCounts counts_without(const FrameCounts& with, const HiddenShares& shares) {
  FrameCounts without = with;
  without.visits /= visits_factor(shares);
  return without;
}

// Counts that depend on the number of triangles grow with it; pixels do not.
FrameForecast same_error_without(const Calibration& calibration, const Prospect& prospect, const EffortForecast& chosen,
                                 std::size_t full_triangles) {
  FrameCounts counts = prospect.counts;
  const double most = std::max(static_cast<double>(full_triangles) / counts.triangles, 1.0);
  const double factor = std::min(triangles_for(chosen.error, shares_for(chosen.effort, prospect).finer), most);
  counts.triangles *= factor;
  counts.splits *= factor;
  counts.kept_splits *= factor;
  counts.visits *= factor;
  return {counts.triangles, frame_ms_without(calibration, counts)};
}

double error_with(double hidden, const FinerCounts& finer) {
  constexpr double min_error = 0.05;  // limits the gain claimed by small samples
  if (hidden <= 0.0) return 1.0;
  const double wanted = 1.0 / (1.0 - std::min(hidden, max_hidden));
  std::size_t i = 1;
  while (i < finer.size() && finer[i] < wanted) ++i;
  if (i == finer.size()) return min_error;
  const double part = std::log(wanted / finer[i - 1]) / std::log(finer[i] / finer[i - 1]);
  return std::max(std::exp2(-(static_cast<double>(i - 1) + part)), min_error);
}

double triangles_for(double error, const FinerCounts& finer) {
  const double halvings = std::clamp(-std::log2(error), 0.0, static_cast<double>(finer.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(halvings), finer.size() - 2);
  return finer[i] * std::pow(finer[i + 1] / finer[i], halvings - static_cast<double>(i));
}

// Hidden surface adds nothing to the squared error. The factor is fitted to the shipped scenes, where the error is 0.5
// to 1.2 times the level.
double picture_error_px(double level_px, double hidden) { return 0.8 * level_px * std::sqrt(1.0 - hidden); }

std::vector<EffortForecast> forecasts(const Calibration& calibration, const Prospect& prospect) {
  std::vector<EffortForecast> all;
  all.push_back({OcclusionEffort::none, {}, frame_ms_without(calibration, prospect.counts), 0.0, 1.0});
  for (std::size_t backend = 0; backend < calibration.backends.size(); ++backend)
    for (std::size_t i = 1; i < occlusion_effort_count; ++i) {
      const auto effort = static_cast<OcclusionEffort>(i);
      if (prospect.way == Way::from_scratch || is_renewed(effort))
        all.push_back(forecast(calibration, backend, effort, prospect));
    }
  return all;
}

// A hidden star is one split. The larger the error of a node, the more splits are assumed below it, by the law by which
// they become more below the level; all hidden subtrees of a region are assumed to have their mean error.
double splits_freed(const ObjectEffectStats::Region& region, double level_px, const FinerCounts& finer) {
  constexpr double min_level_px = 0.1;
  const auto subtrees = static_cast<double>(region.hidden - region.hidden_stars);
  if (subtrees == 0.0) return region.hidden_stars;
  const double mean_px = static_cast<double>(region.hidden_subtrees_px) / subtrees;
  const double exponent = std::clamp(std::log2(finer[1]), 1.0, 2.0);
  return region.hidden_stars + subtrees * std::pow(mean_px / std::max(level_px, min_level_px), exponent);
}

double split_worth_ns(const Calibration& calibration, const FrameCounts& counts) {
  return 1e6 * frame_ms_without(calibration, counts) / std::max({counts.splits, counts.kept_splits, 1.0});
}

QueryRates usual_query_rates(Way way) noexcept {
  if (way == Way::going_on) return {0.0, 0.0, 0.03, 0.0, 0.1};
  return {0.0, 0.68, 0.71, 0.92, 0.95};
}

// A node, its star and the positions that it names take some 250 bytes. Half of the visits miss the caches when there
// are four times as many splits as fill the caches of the machines that this was fitted on.
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

std::string_view name_of(OcclusionEffort effort) noexcept {
  switch (effort) {
    case OcclusionEffort::none:
      return "none";
    case OcclusionEffort::subtrees:
      return "subtrees";
    case OcclusionEffort::renewed_subtrees:
      return "renewed-subtrees";
    case OcclusionEffort::stars:
      return "stars";
    case OcclusionEffort::renewed_stars:
      break;
  }
  return "renewed-stars";
}

RefineOptions EffectChoice::with(RefineOptions options) const {
  const bool renewed = effort == OcclusionEffort::renewed_subtrees || effort == OcclusionEffort::renewed_stars;
  Tuning& tuning = tune(options);
  tuning.occluder_splits.clear();
  if (!renewed) tuning.occluder_splits.push_back(single_occluder_splits(options.budget));
  tuning.ask_stars = effort == OcclusionEffort::stars || effort == OcclusionEffort::renewed_stars;
  tuning.level_step = level_step;
  tuning.retest_hidden = renewed;
  tuning.final_check = false;
  options.effects = objects;
  return options;
}

}  // namespace occlod
