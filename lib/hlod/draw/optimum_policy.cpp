// Strategy::optimum: what single queries can reach at best (Guthe, Balazs and Klein 2006, sec. 5.1). An oracle tells
// what is hidden; of each hidden part the cheapest is done: asking, asking about its children, or drawing.
#include <limits>

#include "hlod/draw/per_node.h"
#include "hlod/draw/policy.h"
#include "hlod/draw/work_below.h"

namespace occlod::hlod {
namespace {

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
    double least_ns = 0.0, sum_ns = 0.0;
    for (const NodeId id : scene.hlod(n).children(n.node))
      if (scene.view_of(n).may_be_inside(scene.hlod(n).node(id).box))
        least_ns += std::min(costs.draw_ns, costs.query_ns);
    if (least_ns >= enough) return least_ns;
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

}  // namespace

std::unique_ptr<Policy> make_optimum_policy() { return std::make_unique<OptimumPolicy>(); }

}  // namespace occlod::hlod
