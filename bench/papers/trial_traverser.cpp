#include "papers/trial_traverser.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hlod/draw/policy.h"
#include "hlod/draw/query_value.h"

namespace occlod::hlod {
namespace {

// TrialStrategy::sw and sw_b: hierarchical stop-and-wait (Bittner and others 2004; SW-eps and SW-eps^q in Charalambos
// 2006).

class WaitingPolicy : public Policy {
 public:
  explicit WaitingPolicy(bool biased) : biased_(biased) {}
  [[nodiscard]] Action predict(FrameScene&, const ReachedNode&) override { return Action::delay; }
  [[nodiscard]] bool biased() const noexcept override { return biased_; }
  [[nodiscard]] bool waits() const noexcept override { return true; }

 private:
  bool biased_;
};

// TrialStrategy::boolean: coherent hierarchical culling (Bittner and others 2004) as Gobetti & Marton 2005 use it;
// algorithms 1 to 4 in Charalambos 2006.

class BooleanPolicy : public Policy {
 public:
  [[nodiscard]] Action predict(FrameScene& scene, const ReachedNode& n) override {
    if (!scene.last(n.ref).visible) return Action::delay;
    return scene.is_fine(n.ref, 1.0) ? Action::stop : Action::refine;
  }
  [[nodiscard]] bool biased() const noexcept override { return false; }
};

// TrialStrategy::simp: visibility predicted by the place in the queue (Charalambos 2006, sec. 5.2).

class QueuePlacePolicy : public Policy {
 public:
  [[nodiscard]] Action predict(FrameScene& scene, const ReachedNode& n) override {
    if (!scene.last(n.ref).visible) return Action::delay;
    return scene.stops(n.ref, scene.bias(predicted_share(scene, n))) ? Action::stop : Action::refine;
  }

  [[nodiscard]] double bias(const FrameScene& scene, const ReachedNode& n) const override {
    return scene.bias(predicted_share(scene, n));
  }

 private:
  // What is near is reached early and tends to be visible: from 1 for the first nearly to 0 for the last of as many as
  // there were in the last frame, and for what comes after it.
  static double predicted_share(const FrameScene& scene, const ReachedNode& n) {
    const std::uint32_t all = scene.reached_last();
    return 1.0 - static_cast<double>(std::min(n.place, all - 1)) / static_cast<double>(all);
  }
};

// TrialStrategy::two_pass: as GPU-driven engines do (Haar & Aaltonen 2015; Nanite): draw what was visible, test
// everything else and what was drawn against that, draw what shows.

class TwoPassPolicy : public Policy {
 public:
  void begin_frame(const FrameScene&) override { has_tested_ = false; }

  [[nodiscard]] Action predict(FrameScene& scene, const ReachedNode& n) override {
    const bool is_fine = scene.is_fine(n.ref, 1.0);
    if (has_tested_) return is_fine ? Action::draw : Action::refine;
    if (!scene.last(n.ref).visible) return Action::delay;
    return is_fine ? Action::stop : Action::refine;
  }
  bool end_round(const FrameScene&, std::size_t) override { return has_tested_ = true; }

  [[nodiscard]] bool biased() const noexcept override { return false; }
  [[nodiscard]] Asking asking() const noexcept override { return Asking::by_rounds; }

 private:
  bool has_tested_ = false;
};

// TrialStrategy::cesium: the rule of cesium-native. A node that wants to be refined is asked about; hidden ones, and
// new ones of which nothing is known yet, are drawn as they are. Answers are for the next frame. There queries outlive
// a frame, so the answers are there when the next begins; ours end with it, so those that are late are waited for at
// its end, where nothing else is delayed.

class CesiumPolicy : public Policy {
 public:
  void begin_frame(const FrameScene& scene) override { memory_.fit(scene); }

  [[nodiscard]] Action predict(FrameScene& scene, const ReachedNode& n) override {
    if (scene.is_fine(n.ref, 1.0)) return Action::draw;
    const Memory& memory = memory_[n.ref];
    const bool is_known = memory.frame > 0 && memory.frame + 1 == scene.frame();
    return (is_known ? memory.visible : scene.last(n.ref).refined) ? Action::descend : Action::stop;
  }
  void note_answer(const FrameScene& scene, NodeRef n, bool visible) override { memory_[n] = {scene.frame(), visible}; }

  [[nodiscard]] bool biased() const noexcept override { return false; }
  [[nodiscard]] bool answers_decide() const noexcept override { return false; }
  [[nodiscard]] bool waits_for_late_answers() const noexcept override { return true; }

 private:
  struct Memory {
    std::uint32_t frame = 0;  // of the answer
    bool visible = false;
  };
  PerNode<Memory> memory_;
};

// TrialStrategy::chc_plus: CHC++ (Mattausch, Bittner and Wimmer, "CHC++: Coherent Hierarchical Culling Revisited",
// 2008).

constexpr std::uint32_t min_wait = 5, max_wait = 10;  // frames between questions about visible leaves (sec. 4.1)
constexpr int deepest = 3;                            // levels down to which boxes are refined (sec. 4.3)
constexpr double max_area = 1.4;                      // of them, relative to the node's

// A mixer of integers (SplitMix64): the same on every machine.
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

class GroupingPolicy : public Policy {
 public:
  void begin_frame(const FrameScene& scene) override {
    memory_.fit(scene);
    groups_.begin_frame(scene);
  }

  [[nodiscard]] Action predict(FrameScene& scene, const ReachedNode& reached) override {
    const NodeRef n = reached.ref;
    const LastFrame last = scene.last(n);
    if (!last.visible) return Action::delay;
    if (!scene.is_fine(n, 1.0)) return Action::refine;
    Memory& memory = memory_[n];
    if (memory.next_question == 0) memory.next_question = scene.frame() + wait(scene, n, 1);
    if (scene.frame() < memory.next_question) return Action::draw;
    memory.next_question = scene.frame() + wait(scene, n, min_wait);
    return Action::stop;
  }

  void note_answer(const FrameScene&, NodeRef n, bool visible) override {
    groups_.note_answer(n, visible);
    if (!visible) memory_[n].next_question = 0;
  }

  [[nodiscard]] std::size_t group(const FrameScene&, std::span<NodeRef> hidden) override {
    return groups_.group(hidden);
  }

  // The boxes below it, as long as they are hardly larger together. Only nodes that will be refined have all that is
  // drawn inside the boxes of their children.
  void add_boxes(const FrameScene& scene, NodeRef n, std::vector<BoxRef>& boxes) override {
    level_.assign(1, n);
    const double limit = max_area * box_area(scene.node(n).box);
    for (int i = 0; i < deepest && refine_level(scene, limit); ++i) {
    }
    for (const NodeRef below : level_) boxes.push_back({below.object, scene.node(below).box});
  }

  [[nodiscard]] bool biased() const noexcept override { return false; }
  [[nodiscard]] Asking asking() const noexcept override { return Asking::by_groups; }

 private:
  struct Memory {
    std::uint32_t next_question = 0;  // frame; 0: none
  };

  static std::uint32_t wait(const FrameScene& scene, NodeRef n, std::uint32_t least) {
    const std::uint64_t seed = mixed((std::uint64_t{n.object} << 32U | n.node) ^ mixed(scene.frame()));
    return least + static_cast<std::uint32_t>(seed % (max_wait - least + 1));
  }

  // Replaces level_ by what is below it. False if that is too large, or nothing.
  bool refine_level(const FrameScene& scene, double limit) {
    next_.clear();
    double area = 0.0;
    bool refined = false;
    for (const NodeRef n : level_) {
      const bool is_fine = scene.is_fine(n, 1.0);
      refined = refined || !is_fine;
      if (is_fine) next_.push_back(n);
      if (is_fine) area += box_area(scene.node(n).box);
      if (is_fine) continue;
      for (const NodeId child : scene.hlod(n).children(n.node)) {
        next_.push_back({n.object, child});
        area += box_area(scene.node(next_.back()).box);
        if (area > limit) return false;
      }
    }
    if (refined && area <= limit) level_.swap(next_);
    return refined && area <= limit;
  }

  PerNode<Memory> memory_;
  HiddenGroups groups_;
  std::vector<NodeRef> level_, next_;
};

// TrialStrategy::optimum: what single queries can reach at best (Guthe, Balazs and Klein 2006, sec. 5.1). An oracle
// tells what is hidden; of each hidden part the cheapest is done: asking, asking about its children, or drawing.

struct Plan {
  std::uint32_t frame = 0;  // of the oracle
  Action action = Action::drop;
};

// Stop-and-wait, which notes what is hidden and plans what to do about it.
class PlanningPolicy : public Policy {
 public:
  explicit PlanningPolicy(PerNode<Plan>& plans) : plans_(plans) {}

  void begin_frame(const FrameScene& scene) override {
    plans_.fit(scene);
    hidden_.clear();
  }
  [[nodiscard]] Action predict(FrameScene&, const ReachedNode&) override { return Action::delay; }
  void note_answer(const FrameScene&, NodeRef n, bool visible) override {
    if (!visible) hidden_.push_back(n);
  }
  void end_frame(const FrameScene& scene) override {
    for (const NodeRef n : hidden_) plan(scene, n);
  }
  [[nodiscard]] bool biased() const noexcept override { return false; }
  [[nodiscard]] bool waits() const noexcept override { return true; }

 private:
  // ns. A node that another hidden one has planned already costs nothing more, and one that another parent shows is not
  // hidden.
  double plan(const FrameScene& scene, NodeRef n) {
    const NodeState& state = scene.state(n);
    if (plans_[n].frame == scene.frame() || (state.frame == scene.frame() && state.visible)) return 0.0;
    if (!scene.view_of(n).may_be_inside(scene.node(n).box)) return 0.0;
    const DeviceCosts& costs = scene.options().costs;
    const std::optional<double> pixels = scene.view_of(n).box_pixels(scene.node(n));
    const double query_ns = pixels ? query_time_ns(costs, *pixels) : std::numeric_limits<double>::infinity();
    Plan& plan = plans_[n] = {scene.frame(), Action::drop};
    const double other_ns = scene.is_fine(n, 1.0) ? draw_ns(scene, n) : children_ns(scene, n, query_ns);
    if (query_ns <= other_ns) return query_ns;
    plan.action = scene.is_fine(n, 1.0) ? Action::draw : Action::refine;
    return other_ns;
  }

  static double draw_ns(const FrameScene& scene, NodeRef n) {
    return draw_time_ns(scene.options().costs, own_work(scene, n, scene.view_of(n).coverage(scene.node(n).box)));
  }

  // Or something that is not less than `enough`.
  double children_ns(const FrameScene& scene, NodeRef n, double enough) {
    const DeviceCosts& costs = scene.options().costs;
    double min_ns = 0.0, sum_ns = 0.0;
    for (const NodeId id : scene.hlod(n).children(n.node))
      if (scene.view_of(n).may_be_inside(scene.hlod(n).node(id).box)) min_ns += std::min(costs.draw_ns, costs.query_ns);
    if (min_ns >= enough) return min_ns;
    for (const NodeId id : scene.hlod(n).children(n.node)) {
      sum_ns += plan(scene, {n.object, id});
      if (sum_ns >= enough) break;
    }
    return sum_ns;
  }

  PerNode<Plan>& plans_;
  std::vector<NodeRef> hidden_;
};

class OptimumPolicy : public Policy {
 public:
  [[nodiscard]] Action predict(FrameScene& scene, const ReachedNode& n) override {
    if (plans_[n.ref].frame + 1 == scene.frame()) return plans_[n.ref].action;
    return scene.is_fine(n.ref, 1.0) ? Action::draw : Action::refine;
  }
  [[nodiscard]] bool biased() const noexcept override { return false; }
  [[nodiscard]] bool answers_decide() const noexcept override { return false; }
  [[nodiscard]] Policy* oracle() noexcept override { return &oracle_; }

 private:
  PerNode<Plan> plans_;
  PlanningPolicy oracle_{plans_};
};

template <typename Made, auto... arguments>
std::unique_ptr<Policy> make() {
  return std::make_unique<Made>(arguments...);
}

}  // namespace

const Rival* rival_of(TrialStrategy strategy) {
  static constexpr Rival sw{make<WaitingPolicy, false>}, sw_b{make<WaitingPolicy, true>}, boolean{make<BooleanPolicy>},
      simp{make<QueuePlacePolicy>}, chc_plus{make<GroupingPolicy>}, two_pass{make<TwoPassPolicy>},
      cesium{make<CesiumPolicy>};
  static constexpr Rival ideal{.make = make<WaitingPolicy, true>, .needs_oracle = true, .is_ideal = true};
  static constexpr Rival optimum{.make = make<OptimumPolicy>, .needs_costs = true, .needs_oracle = true};
  switch (strategy) {
    case TrialStrategy::sw:
      return &sw;
    case TrialStrategy::sw_b:
      return &sw_b;
    case TrialStrategy::boolean:
      return &boolean;
    case TrialStrategy::simp:
      return &simp;
    case TrialStrategy::ideal:
      return &ideal;
    case TrialStrategy::optimum:
      return &optimum;
    case TrialStrategy::chc_plus:
      return &chc_plus;
    case TrialStrategy::two_pass:
      return &two_pass;
    case TrialStrategy::cesium:
      return &cesium;
    default:
      return nullptr;
  }
}

Strategy strategy_of(TrialStrategy strategy) {
  switch (strategy) {
    case TrialStrategy::coh:
      return Strategy::coh;
    case TrialStrategy::nohc:
      return Strategy::nohc;
    case TrialStrategy::batch:
      return Strategy::batch;
    case TrialStrategy::automatic:
      return Strategy::automatic;
    default:
      return Strategy::vfc;
  }
}

bool needs_costs(TrialStrategy strategy) {
  const Rival* const rival = rival_of(strategy);
  return rival != nullptr ? rival->needs_costs : needs_costs(strategy_of(strategy));
}

TraverseOptions TrialOptions::traverse() const {
  return {strategy_of(strategy), tolerance_px, bias, geomorph, within, costs, prefetch_frames};
}

Trial TrialOptions::trial() const {
  return {rival_of(strategy), biased, metric, alpha, coherence, cover_model, oracle};
}

const Frame& TrialTraverser::draw_frame(const View& view, RenderDevice& device, const TrialOptions& options) {
  set_trial(options.trial());
  return Traverser::draw_frame(view, device, options.traverse());
}

}  // namespace occlod::hlod
