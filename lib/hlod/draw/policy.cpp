#include "hlod/draw/policy.h"

#include <algorithm>
#include <cassert>

#include "hlod/draw/query_value.h"

namespace occlod::hlod {

std::unique_ptr<Policy> make_policy(Strategy strategy) {
  switch (strategy) {
    case Strategy::vfc:
      return make_frustum_policy();
    case Strategy::sw:
      return make_waiting_policy(false);
    case Strategy::sw_b:
    case Strategy::ideal:
      return make_waiting_policy(true);
    case Strategy::boolean:
      return make_boolean_policy();
    case Strategy::simp:
      return make_queue_place_policy();
    case Strategy::coh:
      return make_coherent_policy();
    case Strategy::nohc:
      return make_near_optimal_policy();
    case Strategy::chc_plus:
      return make_grouping_policy();
    case Strategy::two_pass:
      return make_two_pass_policy();
    case Strategy::cesium:
      return make_cesium_policy();
    case Strategy::optimum:
      return make_optimum_policy();
    case Strategy::batch:
      return make_batch_policy();
    case Strategy::automatic:
      break;
  }
  assert(false);
  return nullptr;
}

// Strategy::vfc.

namespace {

class FrustumPolicy : public Policy {
 public:
  [[nodiscard]] Action predict(FrameScene& scene, const ReachedNode& n) override {
    return scene.is_fine(n.ref, 1.0) ? Action::draw : Action::refine;
  }
  [[nodiscard]] bool biased() const noexcept override { return false; }
};

}  // namespace

std::unique_ptr<Policy> make_frustum_policy() { return std::make_unique<FrustumPolicy>(); }

// Strategy::boolean: coherent hierarchical culling (Bittner and others 2004) as Gobetti & Marton 2005 use it;
// algorithms 1 to 4 in Charalambos 2006.

namespace {

class BooleanPolicy : public Policy {
 public:
  [[nodiscard]] Action predict(FrameScene& scene, const ReachedNode& n) override {
    if (!scene.last(n.ref).visible) return Action::delay;
    return scene.is_fine(n.ref, 1.0) ? Action::stop : Action::refine;
  }
  [[nodiscard]] bool biased() const noexcept override { return false; }
};

}  // namespace

std::unique_ptr<Policy> make_boolean_policy() { return std::make_unique<BooleanPolicy>(); }

// Strategy::coh: predicted from the answers of the last frame (Charalambos and others 2007, fig. 3).

namespace {

// Whether all children stopped and would stop again, and the mean of their biases would stop the node, which has none
// of its own. Children that were not visited know nothing; those that were hidden have a bias of 0.
bool may_move_up(FrameScene& scene, NodeRef n) {
  double sum = 0.0;
  int count = 0;
  for (const NodeId id : scene.hlod(n).children(n.node)) {
    const NodeRef child{n.object, id};
    const LastFrame last = scene.last(child);
    if (!last.visited) continue;
    const double bias = scene.state(child).bias;
    if (last.refined || !scene.is_fine(child, bias)) return false;
    sum += bias;
    ++count;
  }
  return scene.stops(n, count > 0 ? sum / count : 1.0);
}

class CoherentPolicy : public Policy {
 public:
  void begin_frame(const FrameScene& scene) override { coherence_ = scene.options().coherence; }
  [[nodiscard]] Action predict(FrameScene& scene, const ReachedNode& n) override {
    return predict_coherent(scene, n.ref, coherence_);
  }
  [[nodiscard]] double bias(const FrameScene& scene, const ReachedNode& n) const override {
    return static_cast<double>(scene.state(n.ref).bias);
  }
  [[nodiscard]] Asking asking() const noexcept override {
    return coherence_ == Coherence::published ? Asking::singly : Asking::late;
  }

 private:
  Coherence coherence_ = Coherence::mended;
};

}  // namespace

Action predict_coherent(FrameScene& scene, NodeRef n, Coherence coherence) {
  const LastFrame last = scene.last(n);
  if (!last.visible) return Action::delay;
  // No bias can change that; the paper would let the front move up by one level a frame only.
  if (scene.is_fine(n, 1.0)) return Action::stop;
  const bool knows_bias = !last.refined || (last.asked && coherence == Coherence::mended);
  if (knows_bias && scene.stops(n, static_cast<double>(scene.state(n).bias))) return Action::stop;
  if (!last.refined || !may_move_up(scene, n)) return Action::refine;
  return coherence == Coherence::mended ? Action::descend : Action::delay;
}

std::unique_ptr<Policy> make_coherent_policy() { return std::make_unique<CoherentPolicy>(); }

// Strategy::sw and sw_b: hierarchical stop-and-wait (Bittner and others 2004; SW-eps and SW-eps^q in Charalambos 2006).

namespace {

class WaitingPolicy : public Policy {
 public:
  explicit WaitingPolicy(bool biased) : biased_(biased) {}
  [[nodiscard]] Action predict(FrameScene&, const ReachedNode&) override { return Action::delay; }
  [[nodiscard]] bool biased() const noexcept override { return biased_; }
  [[nodiscard]] bool waits() const noexcept override { return true; }

 private:
  bool biased_;
};

}  // namespace

std::unique_ptr<Policy> make_waiting_policy(bool biased) { return std::make_unique<WaitingPolicy>(biased); }

// Strategy::simp: visibility predicted by the place in the queue (Charalambos 2006, sec. 5.2).

namespace {

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

}  // namespace

std::unique_ptr<Policy> make_queue_place_policy() { return std::make_unique<QueuePlacePolicy>(); }

// Strategy::two_pass: as GPU-driven engines do (Haar & Aaltonen 2015; Nanite): draw what was visible, test everything
// else and what was drawn against that, draw what shows.

namespace {

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

}  // namespace

std::unique_ptr<Policy> make_two_pass_policy() { return std::make_unique<TwoPassPolicy>(); }

// Strategy::cesium: the rule of cesium-native. A node that wants to be refined is asked about; hidden ones, and new
// ones of which nothing is known yet, are drawn as they are. Answers are for the next frame. There queries outlive a
// frame, so the answers are there when the next begins; ours end with it, so those that are late are waited for at its
// end, where nothing else is delayed.

namespace {

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

}  // namespace

std::unique_ptr<Policy> make_cesium_policy() { return std::make_unique<CesiumPolicy>(); }

}  // namespace occlod::hlod
