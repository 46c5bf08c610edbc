#include "refine/forecast.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "occlod/auto_refiner.h"
#include "refine/occluder.h"
#include "refine/tuning.h"

namespace occlod {
namespace {

constexpr double max_hidden = 0.95;  // limits the shares found by small samples

struct OccluderCounts {
  double draws = 0.0;
  double triangles = 0.0;  // triangles that face the eye, summed over draws
  double layers = 0.0;     // fragments per pixel, summed over draws
};

// Returns the fragments per pixel of an occluder with this many triangles. Looks have counted those of a coarse mesh
// and of one that uses the budget; each doubling in between adds as much.
double layers_of(double triangles, const Prospect& prospect) {
  const double fine = prospect.shares.coverage.front_layers;
  const double doublings = std::log2(std::max(prospect.counts.triangles / coarse_triangles, 2.0));
  const double part = std::clamp(std::log2(triangles / coarse_triangles) / doublings, 0.0, 1.0);
  return std::lerp(prospect.coarse_layers, fine, part);
}

OccluderCounts occluders_of(const Prospect& prospect) {
  const double triangles = prospect.counts.triangles;
  OccluderCounts counts;
  const auto draw = [&](double of) {
    counts.draws += 1.0;
    counts.triangles += of * prospect.shares.coverage.front_share;
    counts.layers += layers_of(of, prospect);
  };
  if (prospect.way == Way::going_on) {
    draw(triangles);
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

EffectForecast forecast(const Calibration& calibration, std::size_t backend, const Prospect& prospect) {
  const BackendCosts& costs = calibration.backends[backend];
  const FrameCounts& counts = prospect.counts;
  const OccluderCounts occluders = occluders_of(prospect);
  EffectForecast result{backend, 0.0, 0.0, 1.0};
  result.occlusion_ms = 1e-6 * (occluders.triangles * costs.occluder_triangle_ns +
                                occluders.layers * counts.pixels * costs.occluder_fragment_ns +
                                occluders.draws * (counts.pixels * costs.occluder_pixel_ns + costs.latency_ns) +
                                prospect.query_rate * counts.triangles * costs.query_ns);
  FrameCounts with = counts;
  with.visits *= visits_factor(prospect.shares);
  result.frame_ms = frame_ms_without(calibration, prospect.with.value_or(with)) + result.occlusion_ms;
  const double error = error_with(prospect.shares.stars_hidden, prospect.shares.growth);
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

// What depends on the number of triangles grows with it; pixels do not.
FrameForecast same_error_without(const Calibration& calibration, const Prospect& prospect, const EffectForecast& chosen,
                                 std::size_t full_triangles) {
  FrameCounts counts = prospect.counts;
  const double most = std::max(static_cast<double>(full_triangles) / counts.triangles, 1.0);
  const double factor = std::min(triangles_for(chosen.error, prospect.shares.growth), most);
  counts.triangles *= factor;
  counts.splits *= factor;
  counts.kept_splits *= factor;
  counts.visits *= factor;
  return {counts.triangles, frame_ms_without(calibration, counts)};
}

double error_with(double hidden, double growth) {
  constexpr double min_error = 0.05;  // limits the gain claimed by small samples
  if (hidden <= 0.0) return 1.0;
  const double wanted = 1.0 / (1.0 - std::min(hidden, max_hidden));
  return growth > 1.0 ? std::max(std::exp2(-std::log(wanted) / std::log(growth)), min_error) : min_error;
}

double triangles_for(double error, double growth) { return std::pow(growth, -std::log2(error)); }

// Hidden surface adds nothing to the squared error. The factor is fitted to the shipped scenes, where the error is 0.5
// to 1.2 times the level.
double picture_error_px(double level_px, double hidden) { return 0.8 * level_px * std::sqrt(1.0 - hidden); }

std::vector<EffectForecast> forecasts(const Calibration& calibration, const Prospect& prospect) {
  std::vector<EffectForecast> all;
  all.push_back({{}, frame_ms_without(calibration, prospect.counts), 0.0, 1.0});
  for (std::size_t backend = 0; backend < calibration.backends.size(); ++backend)
    all.push_back(forecast(calibration, backend, prospect));
  return all;
}

// A hidden star is one split. The splits below a node are taken to be more the larger its error is by the law by which
// they become more below the level, all hidden subtrees of a region to have their mean error.
double splits_freed(const ObjectEffectStats::Region& region, double level_px, double growth) {
  constexpr double min_level_px = 0.1;
  const auto subtrees = static_cast<double>(region.hidden - region.hidden_stars);
  if (subtrees == 0.0) return region.hidden_stars;
  const double mean_px = static_cast<double>(region.hidden_subtrees_px) / subtrees;
  const double exponent = std::clamp(std::log2(growth), 1.0, 2.0);
  return region.hidden_stars + subtrees * std::pow(mean_px / std::max(level_px, min_level_px), exponent);
}

double split_worth_ns(const Calibration& calibration, const FrameCounts& counts) {
  return 1e6 * frame_ms_without(calibration, counts) / std::max({counts.splits, counts.kept_splits, 1.0});
}

double usual_query_rate(Way way) noexcept { return way == Way::going_on ? 0.1 : 0.95; }

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

RefineOptions with_choice(RefineOptions options, const EffectChoice& choice, std::shared_ptr<const Tuning>& tuning) {
  Tuning chosen = tuning_of(options);
  chosen.occluder_splits.clear();
  chosen.ask_stars = true;
  chosen.level_step = 1;
  chosen.retest_hidden = true;
  chosen.final_check = false;
  if (!tuning || !(*tuning == chosen)) tuning = std::make_shared<const Tuning>(std::move(chosen));
  options.tuning = tuning;
  options.effects = choice.objects;
  return options;
}

}  // namespace occlod
