#include "occlod/refine/refiner.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>

#include "cut.h"
#include "occlod/core/error.h"
#include "occluder.h"
#include "queue.h"
#include "star.h"

namespace occlod {
namespace {

// When so many visible splits in a row need more triangles than are left, the budget counts as used up.
constexpr std::size_t most_rejections_in_a_row = 64;

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

// One refinement, from the base meshes to the end of the budget:
//   while there is something that may matter: take the worst; ask whether it is seen; descend below it, or apply it.
// (Birkholz & Rahn, sec. 3.2 and 3.3.) Two deviations: nodes are asked about when their turn comes rather than when
// they are found, so that nothing is spent on those whose turn never comes, except that children of a visible node go
// straight into a flight that has room; and with Culling::star a node is descended and applied by separate questions.
class Refiner::Impl {
 public:
  explicit Impl(std::span<const RefineObject> objects) : objects_(objects.begin(), objects.end()) {
    for (const RefineObject& object : objects_) {
      if (object.hierarchy == nullptr)
        throw Error({"refiner", "object " + std::to_string(cuts_.size()), "has no hierarchy", "build one first"});
      cuts_.emplace_back(*object.hierarchy);
    }
    result_.objects.resize(objects_.size());
  }

  [[nodiscard]] std::size_t base_triangles() const noexcept { return sum(&Hierarchy::base_triangle_count); }
  [[nodiscard]] std::size_t full_triangles() const noexcept { return sum(&Hierarchy::input_triangle_count); }

  const Refinement& refine(const View& view, const RefineOptions& options, Visibility& visibility) {
    begin(view, options, visibility);
    const Clock::time_point start = Clock::now();
    timed([&] { visibility.begin_view(view, views_); });
    for (std::uint32_t i = 0; i < objects_.size(); ++i)
      for (const SplitId root : cuts_[i].hierarchy().data().roots) meet(i, root, no_id, 0);
    run();
    drain();
    emit();
    finish_stats();
    result_.stats.occlusion_ms = occlusion_ms_;
    result_.stats.refine_ms = ms_since(start) - occlusion_ms_;
    return result_;
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
    visibility_ = &visibility;
    views_.clear();
    for (const RefineObject& object : objects_) views_.emplace_back(view, object.object_to_world);
    for (Cut& cut : cuts_) cut.clear();
    queue_.clear();
    pending_.clear();
    hidden_.clear();
    stats_ = {};
    stats_.budget = options.budget;
    triangles_ = base_triangles();
    occluder_ = 0;
    splits_at_occluder_ = 0;
    rejections_in_a_row_ = 0;
    left_ = {};
    occlusion_ms_ = 0.0;
  }

  void run() {
    while (!used_up()) {
      if (occluder_due()) {
        drain();
        draw_occluder();
      }
      // Top the flight up from the global queue.
      while (!queue_.empty() && pending_.size() < visibility_->flight() && must_ask(queue_.top())) {
        ask(queue_.pop());
      }
      if (!pending_.empty() && (queue_.empty() || pending_.size() >= visibility_->flight())) {
        settle();
      } else if (!queue_.empty()) {
        process(queue_.pop());
      } else {
        break;
      }
    }
  }

  [[nodiscard]] bool used_up() const {
    return triangles_ >= options_.budget || rejections_in_a_row_ >= most_rejections_in_a_row;
  }

  // A node comes into sight of the refinement: dropped for good, or offered.
  void meet(std::uint32_t object, SplitId s, SplitId parent, std::uint32_t level) {
    const Hierarchy& hierarchy = cuts_[object].hierarchy();
    hierarchy.require(s);
    const SplitNode& node = hierarchy.node(s);
    if (node.parent != parent)  // else a file that lies about its forest could be walked without an end
      throw Error({"hierarchy", "split " + std::to_string(s), "is not where its parent says", "build it again"});
    const ObjectView& view = views_[object];
    ++stats_.visits;
    if (!view.may_be_inside(node.sphere)) {
      ++stats_.culled_frustum;
      return;
    }
    if (faces_away(node, object)) {
      ++stats_.culled_backface;
      return;
    }
    const ScreenError error(node, view.largest_scale_px(node.sphere));
    if (is_tolerated(error)) return;
    offer({error.quadric_px, error, s, object, level, 0, Entry::Kind::visit});
  }

  // Small enough to be left as it is, and noted as such.
  bool is_tolerated(const ScreenError& error) {
    if (!(options_.tolerance_px > 0.0 && error.guaranteed_px <= static_cast<float>(options_.tolerance_px)))
      return false;
    left_.include(error);
    return true;
  }

  [[nodiscard]] bool faces_away(const SplitNode& node, std::uint32_t object) const {
    return !objects_[object].two_sided && occlod::faces_away(node.cone(), node.sphere, views_[object].eye());
  }

  // Into the flight if it has room for a question that must be asked, else into the global queue.
  void offer(const Entry& entry) {
    if (visibility_->flight() > 1 && pending_.size() < visibility_->flight() && must_ask(entry))
      ask(entry);
    else
      queue_.push(entry);
  }

  [[nodiscard]] bool must_ask(const Entry& entry) const {
    if (occluder_ == 0 || entry.asked_occluder == occluder_) return false;
    if (entry.kind == Entry::Kind::apply) return true;
    return entry.level % options_.level_step == options_.level_step - 1;
  }

  void ask(const Entry& entry) {
    const Hierarchy& hierarchy = cuts_[entry.object].hierarchy();
    VisibilityQuery query{entry.object, {}};
    if (entry.kind == Entry::Kind::apply) {
      query.shape = PointHull{star_.points(hierarchy, entry.split)};
    } else {
      switch (options_.proxy) {
        case Proxy::sphere:
          query.shape = hierarchy.node(entry.split).sphere;
          break;
        case Proxy::box:
          query.shape = hierarchy.node(entry.split).box();
          break;
        case Proxy::cylinder:
          query.shape = hierarchy.node(entry.split).cylinder();
          break;
      }
    }
    timed([&] { visibility_->submit(query); });
    pending_.push_back(entry);
    ++stats_.queries;
  }

  // Takes the oldest answer; what is visible is processed if its turn is still now.
  void settle() {
    Entry entry;
    timed([&] { entry = take_answer(); });
    if (entry.split == no_id) return;
    if (queue_.empty() || queue_.top() < entry)
      process(entry);
    else
      queue_.push(entry);
  }

  // Takes all answers that are still under way, without acting on them.
  void drain() {
    while (!pending_.empty()) {
      Entry entry;
      timed([&] { entry = take_answer(); });
      if (entry.split != no_id) queue_.push(entry);
    }
  }

  // The oldest entry asked about, if it is visible; else it joins the hidden ones and no entry comes back.
  Entry take_answer() {
    Entry entry = pending_.front();
    pending_.pop_front();
    if (visibility_->collect() == 0) {
      ++stats_.queries_hidden;
      hidden_.push_back(entry);
      return {};
    }
    entry.asked_occluder = occluder_;
    return entry;
  }

  // At its step, and when all that is left is hidden by an occluder that has since been refined.
  [[nodiscard]] bool occluder_due() const {
    if (!visibility_->can_hide()) return false;
    if (occluder_ < options_.occluder_splits.size() && stats_.splits >= options_.occluder_splits[occluder_])
      return true;
    return queue_.empty() && pending_.empty() && !hidden_.empty() && stats_.splits > splits_at_occluder_;
  }

  void draw_occluder() {
    const std::span<const OccluderPart> parts = occluder_mesh_.build(cuts_, views_, options_.occluder_mode);
    timed([&] { visibility_->draw_occluder(parts); });
    splits_at_occluder_ = stats_.splits;
    ++occluder_;
    ++stats_.occluder_draws;
    // What the older occluder hid is asked about again (sec. 3.2).
    for (const Entry& entry : hidden_) queue_.push(entry);
    hidden_.clear();
  }

  // An entry that is visible as far as we know.
  void process(const Entry& entry) {
    if (entry.kind == Entry::Kind::visit) {
      const SplitNode& node = cuts_[entry.object].hierarchy().node(entry.split);
      if (options_.culling == Culling::subtree)
        apply(entry);
      else
        consider(entry);
      for (const SplitId child : {node.child_u, node.child_v})
        if (child != no_id) meet(entry.object, child, entry.split, entry.level + 1);
    } else {
      apply(entry);
    }
  }

  // Culling::star: does the split itself change anything that is seen, and how much of what it changes?
  void consider(const Entry& entry) {
    const Cut& cut = cuts_[entry.object];
    if (cut.applied(entry.split)) return;
    const ObjectView& view = views_[entry.object];
    const SplitNode& node = cut.hierarchy().node(entry.split);
    const StarView star = star_.look(cut.hierarchy(), entry.split, view, objects_[entry.object].two_sided);
    if (star.visible_share == 0.0F) {
      ++stats_.culled_backface;
      return;
    }
    const ScreenError error(node, view.largest_scale_px(star.sphere));
    if (is_tolerated(error)) return;
    const float weight = std::pow(star.visible_share, static_cast<float>(options_.visible_exponent));
    offer({error.quadric_px * weight, error, entry.split, entry.object, entry.level, 0, Entry::Kind::apply});
  }

  void apply(const Entry& entry) {
    Cut& cut = cuts_[entry.object];
    if (cut.applied(entry.split)) return;
    const Cut::Closure closure = cut.closure(entry.split);
    if (triangles_ + closure.triangles > options_.budget) {
      ++stats_.rejected_splits;
      ++rejections_in_a_row_;
      left_.include(entry.error);
      return;
    }
    rejections_in_a_row_ = 0;
    stats_.splits += closure.splits.size();
    stats_.forced_splits += closure.splits.size() - 1;
    triangles_ -= cut.triangle_count();
    cut.apply_closure();
    triangles_ += cut.triangle_count();
  }

  void emit() {
    for (std::size_t i = 0; i < cuts_.size(); ++i) {
      RefinedObject& object = result_.objects[i];
      cuts_[i].active_triangles(object.triangles, true);
      object.splits.assign(cuts_[i].applied_splits().begin(), cuts_[i].applied_splits().end());
    }
  }

  void finish_stats() {
    stats_.triangles = triangles_;
    stats_.culled_occlusion = hidden_.size();
    for (const Entry& entry : queue_.entries())
      if (!cuts_[entry.object].applied(entry.split)) left_.include(entry.error);
    stats_.max_error_px = static_cast<double>(left_.guaranteed_px);
    stats_.max_quadric_error_px = static_cast<double>(left_.quadric_px);
    result_.stats = stats_;
  }

  template <typename Work>
  void timed(const Work& work) {
    const Clock::time_point start = Clock::now();
    work();
    occlusion_ms_ += ms_since(start);
  }

  std::vector<RefineObject> objects_;
  std::vector<Cut> cuts_;
  std::vector<ObjectView> views_;
  RefineOptions options_;
  Visibility* visibility_ = nullptr;
  Queue queue_;
  std::deque<Entry> pending_;  // asked, oldest first
  std::vector<Entry> hidden_;  // found hidden by the occluder of their time
  Occluder occluder_mesh_;
  StarLook star_;
  std::size_t triangles_ = 0;           // of all cuts
  std::uint32_t occluder_ = 0;          // how many have been drawn
  std::size_t splits_at_occluder_ = 0;  // applied when the last was drawn
  std::size_t rejections_in_a_row_ = 0;
  ScreenError left_;  // the largest of what is held to be visible and is not refined
  double occlusion_ms_ = 0.0;
  RefineStats stats_;
  Refinement result_;
};

Refiner::Refiner(std::span<const RefineObject> objects) : impl_(std::make_unique<Impl>(objects)) {}
Refiner::~Refiner() = default;
Refiner::Refiner(Refiner&&) noexcept = default;
Refiner& Refiner::operator=(Refiner&&) noexcept = default;

std::size_t Refiner::base_triangles() const noexcept { return impl_->base_triangles(); }
std::size_t Refiner::full_triangles() const noexcept { return impl_->full_triangles(); }

const Refinement& Refiner::refine(const View& view, const RefineOptions& options, Visibility& visibility) {
  return impl_->refine(view, options, visibility);
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

}  // namespace occlod
