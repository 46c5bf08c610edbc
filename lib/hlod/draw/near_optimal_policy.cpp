// Strategy::nohc: near optimal hierarchical culling (Guthe, Balazs and Klein 2006, secs. 3 and 4).
#include <cmath>

#include "hlod/draw/policy.h"
#include "hlod/draw/work_below.h"

namespace occlod::hlod {
namespace {

class NearOptimalPolicy : public Policy {
 public:
  void begin_frame(const FrameScene& scene) override {
    work_.begin_frame(scene);
    if (memory_.fit(scene)) count(scene);
    covered_ = 0.0;
    depth_ = scene.options().cover_model == CoverModel::printed ? std::log2(static_cast<double>(nodes_) + 1.0)
                                                                : static_cast<double>(levels_);
    most_asked_ = static_cast<std::size_t>(std::min(most_parallel_queries(scene.options().costs), 1e6));
  }

  [[nodiscard]] Action predict(FrameScene& scene, const ReachedNode& reached) override {
    const NodeRef n = reached.ref;
    work_.note_visited(n);
    const bool is_leaf = scene.is_fine(n, 1.0);
    const LastSight last = last_sight(scene, n);
    Memory& memory = memory_[n];
    if (last == LastSight::outside) memory.asked_frame = scene.frame();  // the wait begins
    if (!is_reasonable(scene, n, is_leaf, last)) return is_leaf ? Action::draw : Action::refine;
    memory.asked_frame = scene.frame();
    if (last == LastSight::hidden) return Action::delay;
    return is_leaf ? Action::stop : Action::descend;
  }

  void note_drawn(const FrameScene& scene, NodeRef n) override {
    work_.note_drawn(scene, n);
    covered_ = covered_with(covered_, own_coverage(scene, n));
  }
  void end_frame(const FrameScene& scene) override { work_.end_frame(scene); }

  [[nodiscard]] bool biased() const noexcept override { return false; }
  [[nodiscard]] std::size_t most_asked() const noexcept override { return most_asked_; }

 private:
  struct Memory {
    std::uint32_t asked_frame = 0;  // or in which the node came into sight
  };
  struct Weighed {
    QueryValue value;
    double occlusion_probability = 0.0;
    DrawWork work;
  };

  void count(const FrameScene& scene) {
    nodes_ = levels_ = 0;
    for (std::uint32_t object = 0; object < scene.object_count(); ++object) {
      nodes_ += scene.hlod({object, 0}).node_count();
      levels_ = std::max(levels_, scene.hlod({object, 0}).level_count());
    }
  }

  [[nodiscard]] Weighed weigh(const FrameScene& scene, NodeRef n, LastSight last) const {
    const DeviceCosts& costs = scene.options().costs;
    const ObjectFrame& view = scene.view_of(n);
    const double coverage = view.coverage(scene.node(n).box);
    const double covered = cover_probability(covered_, coverage, scene.options().cover_model);
    Weighed result;
    result.work = work_.of(scene, n, coverage);
    result.occlusion_probability = occlusion_probability(covered, last);
    result.value = query_value(draw_time_ns(costs, result.work), query_time_ns(costs, coverage * view.pixels()),
                               result.occlusion_probability, depth_);
    return result;
  }

  [[nodiscard]] bool is_reasonable(const FrameScene& scene, NodeRef n, bool is_leaf, LastSight last) const {
    const DeviceCosts& costs = scene.options().costs;
    const Weighed node = weigh(scene, n, last);
    const double waited = static_cast<double>(scene.frame() - memory_[n].asked_frame);
    const AskedBefore before{last, node.occlusion_probability, waited};
    if (is_leaf) return is_query_reasonable(costs, node.value, before, nullptr);
    ChildrenValue children;
    for (const NodeId id : scene.hlod(n).children(n.node)) {
      const NodeRef child{n.object, id};
      if (!scene.view_of(child).may_be_inside(scene.node(child).box)) continue;
      const Weighed weighed = weigh(scene, child, last_sight(scene, child));
      children.query_ns += weighed.value.query_ns;
      children.benefit_ns += weighed.value.benefit_ns;
      children.any_unaskable = children.any_unaskable || weighed.value.draw_ns < weighed.value.query_ns;
    }
    children.leaves = node.work.draws;
    return is_query_reasonable(costs, node.value, before, &children);
  }

  WorkBelow work_;
  PerNode<Memory> memory_;
  double covered_ = 0.0;  // c_scr
  std::size_t nodes_ = 0, levels_ = 0;
  double depth_ = 1.0;
  std::size_t most_asked_ = 1;
};

}  // namespace

std::unique_ptr<Policy> make_near_optimal_policy() { return std::make_unique<NearOptimalPolicy>(); }

}  // namespace occlod::hlod
