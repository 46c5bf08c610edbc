#include "hlod/draw/policy.h"

#include <cassert>

namespace occlod::hlod {
namespace {

// Implements Strategy::vfc.
class FrustumPolicy : public Policy {
 public:
  [[nodiscard]] Action predict(FrameScene& scene, const ReachedNode& n) override {
    return scene.is_fine(n.ref, 1.0) ? Action::draw : Action::refine;
  }
  [[nodiscard]] bool biased() const noexcept override { return false; }
};

// Implements Strategy::coh, which predicts from the answers of the last frame (Charalambos and others 2007, fig. 3).

// Returns whether all children stopped and would stop again, and the mean of their biases would stop the node, which
// has no bias of its own. Children that were not visited do not count; hidden ones have a bias of 0.
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

// Returns whether the last answer about a refined node came through a hole in the front, and a smaller one could stop
// it. The biases of its children do not tell: their mean may be above that of the node.
bool saw_too_much(FrameScene& scene, NodeRef n) {
  constexpr double hardly = 1e-300;
  const NodeState& state = scene.state(n);
  if (!state.through_hole || !scene.is_fine(n, scene.bias(hardly))) return false;
  (void)scene.stops(n, static_cast<double>(state.bias));  // where only a floor has refined the node, it has to stay
  return true;
}

class CoherentPolicy : public Policy {
 public:
  void begin_frame(const FrameScene& scene) override { coherence_ = scene.trial().coherence; }
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
  // No bias can change that. The paper would let the front move up by only one level per frame.
  if (scene.is_fine(n, 1.0)) return Action::stop;
  const bool knows_bias = !last.refined || (last.asked && coherence == Coherence::mended);
  if (knows_bias && scene.stops(n, static_cast<double>(scene.state(n).bias))) return Action::stop;
  if (!last.refined) return Action::refine;
  const bool mends = coherence == Coherence::mended;
  if (!may_move_up(scene, n) && !(mends && saw_too_much(scene, n))) return Action::refine;
  return mends ? Action::descend : Action::delay;
}

std::unique_ptr<Policy> make_policy(Strategy strategy) {
  switch (strategy) {
    case Strategy::vfc:
      return std::make_unique<FrustumPolicy>();
    case Strategy::coh:
      return std::make_unique<CoherentPolicy>();
    case Strategy::nohc:
      return make_near_optimal_policy();
    case Strategy::batch:
      return make_batch_policy();
    case Strategy::automatic:
      break;
  }
  assert(false);
  return nullptr;
}

}  // namespace occlod::hlod
