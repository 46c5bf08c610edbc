#include "occlod/refiner.h"

#include <fmt/format.h>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/option_checker.h"
#include "base/placement.h"
#include "base/threads.h"
#include "base/timing.h"
#include "occlod/base.h"
#include "refine/frames.h"
#include "refine/from_scratch.h"
#include "refine/refined_scene.h"
#include "refine/tuning.h"

namespace occlod {

void require_parent(const Hierarchy& hierarchy, SplitId s, SplitId parent) {
  if (hierarchy.node(s).parent != parent)
    throw Error({"hierarchy", "split " + std::to_string(s), "is not where its parent says", "build it again"});
}

namespace {

constexpr double largest_exponent = 8.0, least_factor = 1e-3;  // others take weights out of the range of floats

void check_ascending(const std::vector<std::uint32_t>& splits) {
  for (std::size_t i = 1; i < splits.size(); ++i)
    if (splits[i] <= splits[i - 1])
      throw Error({"refinement", "option tuning.occluder_splits",
                   fmt::format("{} follows {}", splits[i], splits[i - 1]), "give ascending numbers"});
}

}  // namespace

void check_options(const RefineOptions& options) {
  const OptionChecker check("refinement");
  check.at_least("tolerance_px", options.tolerance_px, 0.0);
  check.at_least("time_limit_ms", options.time_limit_ms, 0.0);
  check.in_range("threads", options.threads, 0, 1024);
  const Tuning& tuning = tuning_of(options);
  check.in_range("tuning.visible_exponent", tuning.visible_exponent, 0.0, largest_exponent);
  check.in_range("tuning.grazing_exponent", tuning.grazing_exponent, 0.0, largest_exponent);
  check.in_range("tuning.forced_exponent", tuning.forced_exponent, 0.0, largest_exponent);
  check.in_range("tuning.covered_factor", tuning.covered_factor, least_factor, 1.0);
  check_ascending(tuning.occluder_splits);
  check.at_least("tuning.level_step", tuning.level_step, 1.0);
  check.below("tuning.hysteresis", tuning.hysteresis, 0.0, 1.0);
}

bool operator==(const RefineOptions& a, const RefineOptions& b) {
  return a.budget == b.budget && a.tolerance_px == b.tolerance_px && a.mode == b.mode &&
         a.max_changes == b.max_changes && a.time_limit_ms == b.time_limit_ms &&
         a.geomorph_frames == b.geomorph_frames && a.threads == b.threads && a.effects == b.effects &&
         a.method == b.method && tuning_of(a) == tuning_of(b);
}

std::uint64_t Refinement::hash() const noexcept {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  const auto add = [&](std::uint64_t value) { hash = (hash ^ value) * 0x100000001b3ULL; };
  for (const RefinedObject& object : objects) {
    add(object.triangles.size());
    for (const Triangle& t : object.triangles)
      for (int k = 0; k < 3; ++k) add(t[k]);
  }
  return hash;
}

namespace {

// Returns whether a cut that was refined with one can go on with the other. What else is asked about occlusion may
// change: each frame forgets what it would not ask.
bool go_on_alike(const RefineOptions& a, const RefineOptions& b) {
  Tuning before = tuning_of(a);
  const Tuning& now = tuning_of(b);
  before.level_step = now.level_step;
  before.ask_stars = now.ask_stars;
  before.final_check = now.final_check;
  before.hysteresis = now.hysteresis;
  return a.mode == b.mode && before == now;
}

}  // namespace

class Refiner::Impl {
 public:
  explicit Impl(std::span<const RefineObject> objects) : objects_(objects.begin(), objects.end()) {
    for (const RefineObject& object : objects_) {
      if (object.hierarchy == nullptr)
        throw Error({"refiner", "object " + std::to_string(cuts_.size()), "has no hierarchy", "build one first"});
      cuts_.add(*object.hierarchy);
      importances_.emplace_back(object);
    }
    result_.objects.resize(objects_.size());
  }

  [[nodiscard]] std::size_t base_triangles() const noexcept { return cuts_.base_triangle_count(); }
  [[nodiscard]] std::size_t full_triangles() const noexcept { return sum(&Hierarchy::input_triangle_count); }

  void set_transform(std::size_t object, const glm::dmat4& object_to_world) {
    if (object >= objects_.size())
      throw Error({"refiner", "object " + std::to_string(object), "is not there",
                   "there are " + std::to_string(objects_.size()) + ", counted from 0"});
    require_placement(object_to_world);
    if (objects_[object].object_to_world == object_to_world) return;
    objects_[object].object_to_world = object_to_world;
    placed_ = true;
  }

  const Refinement& refine(const View& view, const RefineOptions& options, Visibility& visibility) {
    check_options(options);
    const Clock::time_point start = Clock::now();
    begin(view, options, visibility);
    frames_.reset();
    from_scratch_.refine(scene(view), stats_);
    emit();
    finish(start);
    return result_;
  }

  const Refinement& update(const View& view, const RefineOptions& options, Visibility& visibility) {
    check_options(options);
    const Clock::time_point start = Clock::now();
    const bool moved = placed_ || !last_ || last_->visibility != &visibility || last_->camera != view.camera();
    if (frames_ && !moved && options_ == options && frames_->at_rest()) return repeat(start);
    const bool same_backend = last_ && last_->visibility == &visibility;
    if (!go_on_alike(options_, options)) frames_.reset();
    begin(view, options, visibility);
    last_ = {view.camera(), &visibility};
    placed_ = false;
    if (frames_ && !same_backend) frames_->forget_hidden();
    try {
      choose(view, moved, start);
    } catch (...) {  // the next frame cannot go on from the middle of this one
      frames_.reset();
      throw;
    }
    frames_->emit(result_.objects, stats_);
    stats_.splits = 0;
    for (const RefinedObject& object : result_.objects) stats_.splits += object.splits.size();
    finish(start);
    return result_;
  }

  // Swaps the objects, which stay in place because Frames refers to them.
  [[nodiscard]] Refinement take_result() {
    Refinement taken = result_;
    for (std::size_t i = 0; i < taken.objects.size(); ++i) std::swap(taken.objects[i], result_.objects[i]);
    return taken;
  }

  [[nodiscard]] std::vector<std::uint32_t> visibility_ages(std::size_t object) const {
    const std::vector<SplitId>& splits = result_.objects[object].splits;
    if (!frames_) return std::vector<std::uint32_t>(splits.size(), 0);
    return frames_->visibility_ages(static_cast<std::uint32_t>(object), splits);
  }

 private:
  [[nodiscard]] std::size_t sum(std::size_t (Hierarchy::*count)() const noexcept) const noexcept {
    std::size_t total = 0;
    for (const RefineObject& object : objects_) total += (object.hierarchy->*count)();
    return total;
  }

  void begin(const View& view, const RefineOptions& options, Visibility& visibility) {
    if (options.budget < base_triangles())
      throw Error({"budget", "", "of " + std::to_string(options.budget) + " triangles is smaller than the base meshes",
                   "give at least " + std::to_string(base_triangles())});
    options_ = options;
    views_.clear();
    for (const RefineObject& object : objects_) views_.emplace_back(view, object.object_to_world);
    for (std::size_t i = 0; i < objects_.size(); ++i) importances_[i].begin(views_[i], options_);
    gate_.begin(objects_, options_);
    queries_.begin(visibility, {objects_, views_, &cuts_, &gate_, &view, &options_, thread_count(options_.threads)});
    stats_ = {};
    stats_.budget = options.budget;
  }

  [[nodiscard]] RefinedScene scene(const View& view) {
    return {
        objects_, views_, importances_, &cuts_, &gate_, &queries_, &view, &options_, thread_count(options_.threads)};
  }

  // Refines the cuts for update(), from the frame before or from scratch.
  void choose(const View& view, bool moved, Clock::time_point start) {
    const bool limited = options_.max_changes > 0 || options_.time_limit_ms > 0.0;
    if (frames_ && (frames_->move_to(scene(view)) || limited)) {
      frames_->advance(moved, start, stats_);
    } else {
      from_scratch_.refine(scene(view), stats_);
      if (!frames_) frames_.emplace(objects_, result_.objects);
      frames_->adopt(scene(view), from_scratch_.end_level(), from_scratch_.hidden());
    }
  }

  void emit() {
    for (std::uint32_t i = 0; i < cuts_.size(); ++i) {
      RefinedObject& object = result_.objects[i];
      cuts_.active_wedge_triangles(i, object.triangles, true);
      object.splits.assign(cuts_[i].applied_splits().begin(), cuts_[i].applied_splits().end());
      object.changes.assign(1, {0, static_cast<std::uint32_t>(object.triangles.size())});
      object.geomorphs.clear();
    }
    stats_.new_splits = stats_.splits;
    stats_.changed_triangles = stats_.triangles;
  }

  // Repeats the result of the call before, because nothing has changed since.
  const Refinement& repeat(Clock::time_point start) {
    for (RefinedObject& object : result_.objects) object.changes.clear();
    const RefineStats& last = result_.stats;
    stats_ = {.budget = last.budget,
              .triangles = last.triangles,
              .splits = last.splits,
              .nodes = last.nodes,
              .culled_frustum = last.culled_frustum,
              .culled_backface = last.culled_backface,
              .culled_occlusion = last.culled_occlusion,
              .max_error_px = last.max_error_px,
              .max_quadric_error_px = last.max_quadric_error_px,
              .level_px = last.level_px};
    stats_.refine_ms = milliseconds_since(start);
    result_.stats = stats_;
    return result_;
  }

  void finish(Clock::time_point start) {
    stats_.queries = queries_.counts().asked;
    stats_.queries_hidden = queries_.counts().hidden;
    stats_.occluder_draws = queries_.counts().draws;
    stats_.occlusion_ms = queries_.milliseconds();
    stats_.refine_ms = milliseconds_since(start) - stats_.occlusion_ms;
    result_.stats = stats_;
    result_.effects.assign(gate_.stats().begin(), gate_.stats().end());
  }

  std::vector<RefineObject> objects_;
  CutSet cuts_;
  std::vector<ObjectView> views_;
  std::vector<Importance> importances_;
  RefineOptions options_;
  OcclusionQueries queries_;
  EffectGate gate_;
  FromScratch from_scratch_;
  RefineStats stats_;
  Refinement result_;

  struct Last {
    Camera camera;
    const Visibility* visibility;  // only compared
  };
  bool placed_ = false;           // whether objects have been moved since the last update()
  std::optional<Last> last_;      // camera and backend of the last update()
  std::optional<Frames> frames_;  // set by update(), until the next refine()
};

const Refinement& Refiner::update(const View& view, const RefineOptions& options, Visibility& visibility) {
  return impl_->update(view, options, visibility);
}

void Refiner::set_transform(std::size_t object, const glm::dmat4& object_to_world) {
  impl_->set_transform(object, object_to_world);
}

Refinement Refiner::take_result() { return impl_->take_result(); }

std::vector<std::uint32_t> Refiner::visibility_ages(std::size_t object) const { return impl_->visibility_ages(object); }

Refiner::Refiner(std::span<const RefineObject> objects) : impl_(std::make_unique<Impl>(objects)) {}
Refiner::~Refiner() = default;
Refiner::Refiner(Refiner&&) noexcept = default;
Refiner& Refiner::operator=(Refiner&&) noexcept = default;

std::size_t Refiner::base_triangles() const noexcept { return impl_->base_triangles(); }
std::size_t Refiner::full_triangles() const noexcept { return impl_->full_triangles(); }

const Refinement& Refiner::refine(const View& view, const RefineOptions& options, Visibility& visibility) {
  return impl_->refine(view, options, visibility);
}

}  // namespace occlod
