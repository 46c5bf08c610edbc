#include "occlod/auto_refiner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/timing.h"
#include "occlod/base.h"
#include "occlod/refiner.h"
#include "occlod/visibility.h"
#include "refine/forecast.h"
#include "refine/probe.h"
#include "refine/tuning.h"

namespace occlod {
namespace {

// Estimates what a look back would find from what a look ahead has found: learns how much more a refined mesh hides and
// fills the image than a coarse one, at places where both have been looked at.
class Renewal {
 public:
  void learn(const HiddenShares& ahead, const HiddenShares& back) {
    const auto mix = [&](double& ratio, double now) { ratio = known_ ? std::sqrt(ratio * now) : now; };
    mix(visits_shown_, shown(back.visits_hidden) / shown(ahead.visits_hidden));
    mix(splits_shown_, shown(back.splits_hidden) / shown(ahead.splits_hidden));
    mix(stars_shown_, shown(back.stars_hidden) / shown(ahead.stars_hidden));
    mix(layers_, (1.0 + back.coverage.layers) / (1.0 + ahead.coverage.layers));
    mix(front_layers_, (1.0 + back.coverage.front_layers) / (1.0 + ahead.coverage.front_layers));
    front_share_ = back.coverage.front_share;
    known_ = true;
  }
  [[nodiscard]] bool known() const noexcept { return known_; }
  // Returns what a look back would find where `ahead` has been found; until anything is known, `ahead` itself.
  [[nodiscard]] HiddenShares of(HiddenShares ahead) const {
    ahead.visits_hidden = hidden(visits_shown_ * shown(ahead.visits_hidden));
    ahead.splits_hidden = hidden(splits_shown_ * shown(ahead.splits_hidden));
    ahead.stars_hidden = std::max(hidden(stars_shown_ * shown(ahead.stars_hidden)), ahead.splits_hidden);
    Coverage& coverage = ahead.coverage;
    coverage.layers = (1.0 + coverage.layers) * layers_ - 1.0;
    coverage.front_layers = (1.0 + coverage.front_layers) * front_layers_ - 1.0;
    coverage.front_share = front_share_;
    return ahead;
  }

 private:
  static constexpr double min_shown = 0.05;
  [[nodiscard]] static double shown(double hidden) { return std::max(1.0 - hidden, min_shown); }
  [[nodiscard]] static double hidden(double shown) { return std::clamp(1.0 - shown, 0.0, 1.0 - min_shown); }

  bool known_ = false;
  double visits_shown_ = 1.0, splits_shown_ = 1.0, stars_shown_ = 1.0;
  double layers_ = 1.0, front_layers_ = 1.0, front_share_ = 1.0;
};

// Over all hierarchies, each counted once.
[[nodiscard]] std::size_t splits_of(std::span<const RefineObject> objects) {
  std::vector<const Hierarchy*> hierarchies;
  for (const RefineObject& object : objects) hierarchies.push_back(object.hierarchy);
  std::sort(hierarchies.begin(), hierarchies.end());
  hierarchies.erase(std::unique(hierarchies.begin(), hierarchies.end()), hierarchies.end());
  std::size_t splits = 0;
  for (const Hierarchy* hierarchy : hierarchies) splits += hierarchy->split_count();
  return splits;
}

// The diagonal of the box around the boxes of all objects, world units.
[[nodiscard]] double extent_of(std::span<const RefineObject> objects) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const RefineObject& object : objects)
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 p(object.object_to_world * glm::dvec4(corner(object.hierarchy->box(), i), 1.0));
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  return glm::length(high - low);
}

// The largest distance between two places of a corner of its box, world units.
[[nodiscard]] double moved_by(const RefineObject& from, const RefineObject& to) {
  double moved = 0.0;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec4 p(corner(from.hierarchy->box(), i), 1.0);
    moved = std::max(moved, glm::length((to.object_to_world - from.object_to_world) * p));
  }
  return moved;
}

constexpr std::size_t look_interval = 30;  // views from one look ahead to the next while the camera stays near
// From frame to frame, where a frame takes a fraction of the time, the interval is longer. A camera that moves far
// shortens it, but not below the minimum.
constexpr std::size_t frame_look_interval = 90;
constexpr std::size_t min_frame_look_interval = 30;
// A camera that jumps in every view gets only looks ahead, but for one look back after this many of them.
constexpr std::size_t jumps_per_look_back = 7;
// Number of views from the same place before the first look back, and before later ones.
constexpr std::size_t views_before_look_back = 1, views_before_later_look_back = 3;
// When more than vain_looks_in_turn consecutive looks ahead have found that queries do not pay, up to max_unlooked
// views from elsewhere get no look ahead.
constexpr std::size_t max_unlooked = 3, vain_looks_in_turn = 2;
constexpr double near_cosine = 0.94;  // cosine of the angle by which the camera may turn: 20 degrees
constexpr double near_share = 0.1;    // share of the scene's extent by which the eye may move
constexpr double same_budget_factor = 2.0;
constexpr double same_zoom_factor = 1.25;
constexpr double min_gain = 0.1;              // relative gain of the score for which update() changes the choice
constexpr double min_gain_of_queries = 0.07;  // relative gain of the score for which refine() makes any queries
constexpr double new_share = 0.25;            // weight of the last frame in the running means of frames
// The first frames after a new choice, until everything has been queried once, do not predict later ones.
constexpr std::size_t settling_frames = 8;
constexpr double min_queries = 24.0;          // queries before a region is judged
constexpr std::size_t min_cone_tests = 128;   // tests before an object's cones are judged
constexpr std::size_t min_samples = 12;       // samples, none hidden, before an object is no longer queried
constexpr double visits_saved_by_cone = 4.0;  // lower bound, for each culled subtree

// Returns the calibration with its backends in the order of `backends`. Throws Error when one is missing.
Calibration matched(Calibration calibration, std::span<const std::unique_ptr<Visibility>> backends) {
  check_calibration(calibration);
  std::vector<BackendCosts> costs;
  for (const std::unique_ptr<Visibility>& backend : backends) {
    const auto found = std::find_if(calibration.backends.begin(), calibration.backends.end(),
                                    [&](const BackendCosts& c) { return c.name == backend->name(); });
    if (found == calibration.backends.end())
      throw Error({"calibration", std::string(backend->name()), "is not in it", "measure it again with this backend"});
    costs.push_back(*found);
  }
  calibration.backends = std::move(costs);
  return calibration;
}

std::vector<std::unique_ptr<Visibility>> or_software(std::vector<std::unique_ptr<Visibility>> backends) {
  if (backends.empty()) backends.push_back(make_software_occlusion());
  for (std::size_t i = 0; i < backends.size(); ++i)
    if (!backends[i]) throw Error({"auto refiner", "backend " + std::to_string(i), "is missing", "give a backend"});
  return backends;
}

}  // namespace

// Looks ahead when a look is due, chooses by forecast, refines, records the counts, and looks back when a look is due.
// Looks are rare, so a scene without occlusion pays hardly anything for them.
class AutoRefiner::Impl {
 public:
  Impl(std::span<const RefineObject> objects, const std::optional<Calibration>& calibration,
       std::vector<std::unique_ptr<Visibility>> backends)
      : objects_(objects.begin(), objects.end()),
        refiner_(objects),
        probe_(objects),
        backends_(or_software(std::move(backends))),
        calibration_(matched(calibration ? *calibration : measure_calibration(backends_), backends_)),
        extent_(extent_of(objects)),
        far_share_(far_share(splits_of(objects))),
        effects_(objects.size()),
        worths_(objects.size()),
        was_judged_(objects.size(), false) {}

  [[nodiscard]] const Calibration& calibration() const { return calibration_; }
  [[nodiscard]] const Refiner& refiner() const { return refiner_; }
  [[nodiscard]] Refinement take_result() { return refiner_.take_result(); }
  [[nodiscard]] const EffectReport& report() const { return report_; }
  [[nodiscard]] Visibility& backend(std::size_t index) const { return *backends_[index]; }

  void set_transform(std::size_t object, const glm::dmat4& object_to_world) {
    refiner_.set_transform(object, object_to_world);
    probe_.set_transform(object, object_to_world);
    glm::dmat4& place = objects_[object].object_to_world;
    if (place == object_to_world) return;
    place = object_to_world;
    extent_ = extent_of(objects_);
    placed_ = true;
  }

  const Refinement& refine(const View& view, const RefineOptions& options) {
    check_options(options);
    if (options.budget < refiner_.base_triangles()) return refiner_.refine(view, options, none_);  // throws Error
    last_.reset();
    choose(Way::from_scratch, view, options);
    const Refinement& refinement =
        refiner_.refine(view, with_choice(options, report_.choice, tuning_), chosen_backend());
    learn(Way::from_scratch, view, options, refinement);
    return refinement;
  }

  const Refinement& update(const View& view, const RefineOptions& options) {
    check_options(options);
    if (options.budget < refiner_.base_triangles()) return refiner_.update(view, options, none_);  // throws Error
    const bool stands = !placed_ && last_ && last_->camera == view.camera() && last_->options == options;
    if (stands) {
      report_.looked_ahead = report_.looked_back = false;
      report_.look_ms = 0.0;
    } else {
      choose(Way::going_on, view, options);
    }
    last_ = {view.camera(), options};
    placed_ = false;
    const Refinement& refinement =
        refiner_.update(view, with_choice(options, report_.choice, tuning_), chosen_backend());
    report_.objects = refinement.effects;
    if (stands) return refinement;
    const bool goes_on = refinement.stats.new_splits < refinement.stats.splits;
    learn(goes_on ? Way::going_on : Way::from_scratch, view, options, refinement);
    return refinement;
  }

 private:
  // Holds counts of earlier views. look_ahead() forgets `known` when the camera has moved far.
  struct Counted {
    std::optional<FrameCounts> without, with;  // queries
    double query_rate = 0.0;
  };
  [[nodiscard]] Counted& counted(Way way) { return way == Way::going_on ? going_on_ : from_scratch_; }
  [[nodiscard]] Visibility& chosen_backend() {
    const std::optional<std::size_t>& backend = report_.choice.backend;
    return backend ? *backends_[*backend] : none_;
  }

  [[nodiscard]] bool must_look(Way way, const View& view, const RefineOptions& options) {
    const bool goes_on = way == Way::going_on;
    if (!looked_from_ || views_since_look_ >= (goes_on ? frame_look_interval : look_interval)) return true;
    if (goes_on && views_since_look_ < min_frame_look_interval) return false;
    if (!is_far_from_last_look(view, options)) return false;
    const std::size_t vain = vain_looks_ - std::min(vain_looks_, vain_looks_in_turn);
    return goes_on || ++unlooked_ > std::min(vain, max_unlooked);
  }
  [[nodiscard]] bool is_far_from_last_look(const View& view, const RefineOptions& options) const {
    const double growth = static_cast<double>(options.budget) / static_cast<double>(looked_with_.budget);
    const double zoom = view.focal_length_px() / looked_from_->focal_length_px();
    return tuning_of(options).culling != tuning_of(looked_with_).culling || options.mode != looked_with_.mode ||
           growth > same_budget_factor || growth * same_budget_factor < 1.0 || zoom > same_zoom_factor ||
           zoom * same_zoom_factor < 1.0 || view.is_orthographic() != looked_from_->is_orthographic() ||
           glm::dot(view.direction(), looked_from_->direction()) < near_cosine ||
           glm::distance(view.camera().eye, looked_from_->camera().eye) > near_share * extent_ || has_moved_far();
  }

  [[nodiscard]] bool has_moved_far() const {
    for (std::size_t i = 0; i < objects_.size(); ++i)
      if (moved_by(looked_at_[i], objects_[i]) > near_share * extent_) return true;
    return false;
  }

  void look_ahead(Way way, const View& view, const RefineOptions& options) {
    const Clock::time_point start = Clock::now();
    const Probe::Result& result = probe_.look_ahead(view, options);
    ahead_ = result.all;
    // From frame to frame the counts follow the camera, so they are kept.
    const bool forgets = way == Way::from_scratch || options.budget != looked_with_.budget;
    if (looked_from_ && forgets && is_far_from_last_look(view, options)) {
      back_.reset();
      for (Counted* const counted : {&from_scratch_, &going_on_}) counted->without = counted->with = {};
    }
    for (std::size_t i = 0; i < effects_.size(); ++i) {
      const HiddenShares& seen = result.objects[i];
      effects_[i] = {};
      effects_[i].occlusion =
          seen.visits < min_samples || seen.visits_hidden + seen.splits_hidden + seen.stars_hidden > 0.0;
      worths_[i] = {};
      was_judged_[i] = false;
    }
    looked_from_ = view;
    looked_at_ = objects_;
    looked_with_ = options;
    views_since_look_ = 0;
    back_due_ = true;
    ++jumps_;
    unlooked_ = 0;
    report_.looked_ahead = true;
    report_.look_ms += milliseconds_since(start);
  }

  void look_back(const View& view, const RefineOptions& options, const Refinement& refinement, double level_px) {
    const Clock::time_point start = Clock::now();
    const Probe::Result& result = probe_.look_back(view, options, refinement, level_px);
    back_ = result.all;
    // A coarse mesh may hide nothing of an object of which a fine one hides something.
    for (std::size_t i = 0; i < effects_.size(); ++i)
      if (!was_judged_[i] && result.objects[i].stars_hidden > 0.0) effects_[i].occlusion = true;
    renewal_.learn(ahead_, *back_);
    back_due_ = false;
    jumps_ = 0;
    report_.looked_back = true;
    report_.look_ms += milliseconds_since(start);
  }

  // Chooses the effects for a view, after a look ahead when one is due.
  void choose(Way way, const View& view, const RefineOptions& options) {
    const EffectChoice choice_before = std::move(report_.choice);
    report_ = {};
    if (must_look(way, view, options)) look_ahead(way, view, options);
    // From scratch a choice is kept where only views with queries have been counted: what a frame without them takes is
    // the guess then.
    const bool has_only_asked = from_scratch_.with && !from_scratch_.without && choice_before.backend;
    const bool had_choice = way == Way::going_on ? last_.has_value() : has_only_asked;
    const EffectChoice* const before = had_choice ? &choice_before : nullptr;
    ++views_since_look_;
    const Prospect prospect = prospect_of(way, view, options);
    report_.forecasts = forecasts(calibration_, prospect);
    const EffectForecast* const best = best_forecast(way, before);
    if (report_.looked_ahead) vain_looks_ = best->backend ? 0 : vain_looks_ + 1;
    EffectChoice& choice = report_.choice;
    choice.backend = best->backend;
    const bool stays = before != nullptr && before->backend == choice.backend;
    frames_with_choice_ = stays ? frames_with_choice_ + 1 : 0;
    choice.objects = effects_;
    if (way == Way::going_on)
      for (ObjectEffects& effects : choice.objects) effects.cones = true;
    report_.ahead = ahead_;
    report_.back = back_;
    report_.same_error_without = same_error_without(calibration_, prospect, *best, refiner_.full_triangles());
  }

  // Returns the counts without occlusion: those of views near this one, else of other views of the scene, else the
  // usual ones of the shipped scenes.
  [[nodiscard]] FrameCounts counts_so_far(Way way, std::size_t budget, const View& view) const {
    const Counted& past = way == Way::going_on ? going_on_ : from_scratch_;
    if (past.without) return *past.without;
    FrameCounts counts = usual_counts(way, budget, view, far_share_);
    if (way == Way::from_scratch && visits_per_triangle_) counts.visits = *visits_per_triangle_ * counts.triangles;
    return counts;
  }
  [[nodiscard]] Prospect prospect_of(Way way, const View& view, const RefineOptions& options) {
    const HiddenShares fine = back_ ? *back_ : renewal_.of(ahead_);
    const Counted& past = counted(way);
    Prospect prospect{way,
                      counts_so_far(way, options.budget, view),
                      past.with,
                      ahead_.coverage.front_layers,
                      fine,
                      past.query_rate,
                      picture_error_px(probe_.level_ahead_px(), fine.stars_hidden)};
    if (!past.without && past.with) prospect.counts = counts_without(*past.with, fine);
    prospect.counts.layers = fine.coverage.layers;
    if (prospect.with) prospect.with->layers = fine.coverage.layers;
    return prospect;
  }

  // The best of what may be chosen. Where no object may be queried, occluders would be drawn for nothing.
  [[nodiscard]] const EffectForecast* best_forecast(Way way, const EffectChoice* before) {
    const bool may_ask =
        std::any_of(effects_.begin(), effects_.end(), [](const auto& e) { return e.occlusion && e.regions != 0; });
    const std::span<const EffectForecast> all(report_.forecasts.data(), may_ask ? report_.forecasts.size() : 1);
    const auto best =
        std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.score() < b.score(); });
    // From scratch no queries, the first forecast: what they cost is surer than what they gain.
    const auto same = std::find_if(all.begin(), all.end(), [&](const EffectForecast& forecast) {
      return before == nullptr ? way == Way::from_scratch : forecast.backend == before->backend;
    });
    const double least = before == nullptr ? min_gain_of_queries : min_gain;
    report_.held = same != all.end() && same != best && best->score() > (1.0 - least) * same->score();
    return report_.held ? &*same : &*best;
  }

  // Records the counts of a view, judges what was tested, and looks back when a look is due.
  void learn(Way way, const View& view, const RefineOptions& options, const Refinement& refinement) {
    const RefineStats& stats = refinement.stats;
    report_.objects = refinement.effects;
    const FrameCounts counts = counts_of(way, view, stats);
    const bool asks = report_.choice.backend.has_value();
    Counted& past = counted(way);
    std::optional<FrameCounts>& known = asks ? past.with : past.without;
    const double query_rate = static_cast<double>(stats.queries) / counts.triangles;
    if (way == Way::from_scratch) {
      known = counts;
      if (asks && stats.occluder_draws > 0) past.query_rate = query_rate;
    } else if (frames_with_choice_ >= settling_frames) {
      known = mixed(known.value_or(usual_counts(way, options.budget, view, far_share_)), counts);
      if (asks) past.query_rate = std::lerp(past.query_rate, query_rate, new_share);
    }
    if (way == Way::from_scratch) {
      const HiddenShares fine = back_ ? *back_ : renewal_.of(ahead_);
      const double visits = (asks ? counts_without(counts, fine) : counts).visits / counts.triangles;
      visits_per_triangle_ = visits_per_triangle_ ? std::sqrt(*visits_per_triangle_ * visits) : visits;
    }
    const double level_px = probe_.level_ahead_px();
    for (std::size_t i = 0; i < effects_.size(); ++i) {
      judge_cones(refinement.effects[i], effects_[i]);
      if (asks) judge_regions(refinement.effects[i], level_px, counts, i);
    }
    const std::size_t views = renewal_.known() ? views_before_later_look_back : views_before_look_back;
    const bool has_settled =
        (unlooked_ == 0 && views_since_look_ > views) || jumps_ >= (renewal_.known() ? jumps_per_look_back : 2);
    if (back_due_ && has_settled && options.mode == OccluderMode::paper)
      look_back(view, options, refinement, std::max(level_px, stats.level_px));
  }

  [[nodiscard]] FrameCounts counts_of(Way way, const View& view, const RefineStats& stats) const {
    FrameCounts counts;
    counts.triangles = static_cast<double>(std::max<std::size_t>(stats.triangles, 1));
    counts.splits = static_cast<double>(stats.splits);
    if (way == Way::going_on) {
      counts.kept_splits = counts.splits;
      counts.splits = static_cast<double>(stats.new_splits + stats.merged_splits);
    }
    counts.visits = static_cast<double>(stats.visits);
    counts.pixels = static_cast<double>(view.width()) * view.height();
    counts.far_share = far_share_;
    return counts;
  }

  // Averages what differs between frames; counts change little from one frame to the next, with few exceptions.
  [[nodiscard]] static FrameCounts mixed(const FrameCounts& before, FrameCounts now) {
    now.splits = std::lerp(before.splits, now.splits, new_share);
    now.visits = std::lerp(before.visits, now.visits, new_share);
    return now;
  }

  // Switch off what does not pay on an object, until the next look ahead.
  void judge_cones(const ObjectEffectStats& stats, ObjectEffects& effects) const {
    if (stats.cone_tests < min_cone_tests) return;
    effects.cones = static_cast<double>(stats.cone_culled) * visits_saved_by_cone * calibration_.visit_ns >=
                    static_cast<double>(stats.cone_tests) * calibration_.cone_ns;
  }
  void judge_regions(const ObjectEffectStats& stats, double level_px, const FrameCounts& counts, std::size_t object) {
    const double worth_ns = split_worth_ns(calibration_, counts);
    const double query_ns = calibration_.backends[*report_.choice.backend].query_ns;
    const auto is_vain = [&](const Worth& sum) {
      return sum.queries >= min_queries && sum.splits * worth_ns < sum.queries * query_ns;
    };
    Worth whole;
    const double growth = (back_ ? *back_ : ahead_).growth;
    for (std::size_t r = 0; r < effect_region_count; ++r) {
      Worth& sum = worths_[object][r];
      sum.queries += stats.regions[r].queries;
      sum.splits += splits_freed(stats.regions[r], level_px, growth);
      if (is_vain(sum)) effects_[object].regions &= ~(std::uint64_t{1} << r);
      whole.queries += sum.queries;
      whole.splits += sum.splits;
    }
    if (!is_vain(whole)) return;
    effects_[object].occlusion = false;
    was_judged_[object] = true;
  }

  std::vector<RefineObject> objects_;
  bool placed_ = false;  // whether objects have been moved since the last update()
  Refiner refiner_;
  Probe probe_;
  NoOcclusion none_;
  std::vector<std::unique_ptr<Visibility>> backends_;
  Calibration calibration_;
  std::vector<RefineObject> looked_at_;  // the objects at the last look ahead
  double extent_ = 0.0;
  double far_share_ = 0.0;

  std::optional<View> looked_from_;
  RefineOptions looked_with_;
  std::size_t views_since_look_ = 0;
  bool back_due_ = false;
  std::size_t jumps_ = 0;       // looks ahead since the last look back
  std::size_t vain_looks_ = 0;  // consecutive looks ahead after which nothing was queried
  std::size_t unlooked_ = 0;    // views from elsewhere since the last look ahead
  Renewal renewal_;
  std::optional<double> visits_per_triangle_;  // from scratch without occlusion, mean over all views
  HiddenShares ahead_;
  std::optional<HiddenShares> back_;
  Counted from_scratch_{{}, {}, usual_query_rate(Way::from_scratch)};
  Counted going_on_{{}, {}, usual_query_rate(Way::going_on)};
  struct Last {
    Camera camera;
    RefineOptions options;
  };
  std::optional<Last> last_;            // camera and options of the last update(), unless refine() followed
  std::size_t frames_with_choice_ = 0;  // frames before the last one with the same choice
  std::vector<ObjectEffects> effects_;
  struct Worth {
    double queries = 0.0;
    double splits = 0.0;  // number freed by hidden answers
  };
  std::vector<std::array<Worth, effect_region_count>> worths_;  // since the last look ahead
  std::vector<bool> was_judged_;          // by what its queries took, since then: found not worth it
  std::shared_ptr<const Tuning> tuning_;  // of the last view
  EffectReport report_;
};

AutoRefiner::AutoRefiner(std::span<const RefineObject> objects, const std::optional<Calibration>& calibration,
                         std::vector<std::unique_ptr<Visibility>> backends)
    : impl_(std::make_unique<Impl>(objects, calibration, std::move(backends))) {}
AutoRefiner::~AutoRefiner() = default;
AutoRefiner::AutoRefiner(AutoRefiner&&) noexcept = default;
AutoRefiner& AutoRefiner::operator=(AutoRefiner&&) noexcept = default;

const Calibration& AutoRefiner::calibration() const noexcept { return impl_->calibration(); }
std::size_t AutoRefiner::base_triangles() const noexcept { return impl_->refiner().base_triangles(); }
std::size_t AutoRefiner::full_triangles() const noexcept { return impl_->refiner().full_triangles(); }
void AutoRefiner::set_transform(std::size_t object, const glm::dmat4& object_to_world) {
  impl_->set_transform(object, object_to_world);
}
const Refinement& AutoRefiner::refine(const View& view, const RefineOptions& options) {
  return impl_->refine(view, options);
}
const Refinement& AutoRefiner::update(const View& view, const RefineOptions& options) {
  return impl_->update(view, options);
}
Refinement AutoRefiner::take_result() { return impl_->take_result(); }

std::vector<std::uint32_t> AutoRefiner::visibility_ages(std::size_t object) const {
  return impl_->refiner().visibility_ages(object);
}
const EffectReport& AutoRefiner::report() const noexcept { return impl_->report(); }
Visibility& AutoRefiner::backend(std::size_t index) const noexcept { return impl_->backend(index); }

}  // namespace occlod
