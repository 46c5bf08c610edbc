// Implements the strategies that weigh what queries cost: that of Guthe and others 2006, and ours.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "hlod/draw/policy.h"
#include "hlod/draw/query_value.h"

namespace occlod::hlod {

// Implements Strategy::nohc: near optimal hierarchical culling (Guthe, Balazs and Klein 2006, secs. 3 and 4).

namespace {

class NearOptimalPolicy : public Policy {
 public:
  void begin_frame(const FrameScene& scene) override {
    work_.begin_frame(scene);
    if (memory_.fit(scene)) count(scene);
    covered_.begin_frame(scene);
    // Benefits add up over the levels, in the paper over those of a binary tree.
    depth_ = scene.trial().cover_model == CoverModel::printed ? std::log2(static_cast<double>(nodes_) + 1.0)
                                                              : static_cast<double>(levels_);
    max_asked_ = static_cast<std::size_t>(std::min(max_parallel_queries(scene.options().costs), 1e6));
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
    covered_.note_drawn(scene, n);
  }
  void end_frame(const FrameScene& scene) override { work_.end_frame(scene); }

  [[nodiscard]] bool biased() const noexcept override { return false; }
  [[nodiscard]] std::size_t max_asked() const noexcept override { return max_asked_; }

 private:
  struct Memory {
    std::uint32_t asked_frame = 0;  // frame of the last query, or in which the node came into sight
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
    Weighed result;
    result.work = work_.of(scene, n, coverage);
    result.occlusion_probability = occlusion_probability(covered_.probability(coverage), last);
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
  Covered covered_;
  std::size_t nodes_ = 0, levels_ = 0;
  double depth_ = 1.0;
  std::size_t max_asked_ = 1;
};

}  // namespace

std::unique_ptr<Policy> make_near_optimal_policy() { return std::make_unique<NearOptimalPolicy>(); }

// Implements Strategy::batch. It predicts like Coh(B), but queries nodes together in at most three rounds per frame, or
// hidden nodes in groups. Like NOHC, it decides by costs and savings which nodes to query, and whether to query at all.

namespace {

constexpr int max_rounds = 3;
constexpr double usual_group = 4.0;  // nodes per query, including those that have to be queried again
// The expected savings must be this many times the wait for answers, because only the latter is certain.
constexpr double min_return = 2.0;

// Returns the cost of a frame's queries apart from its boxes: the device idles until the last answers have been read.
double waiting_ns(const DeviceCosts& costs, bool in_groups) {
  return (in_groups ? costs.query_ns : costs.batch_ns) + costs.readback_ns + costs.submit_ns;
}

class BatchPolicy : public Policy {
 public:
  void begin_frame(const FrameScene& scene) override {
    const DeviceCosts& costs = scene.options().costs;
    work_.begin_frame(scene);
    memory_.fit(scene);
    groups_.begin_frame(scene);
    rates_.begin_frame();
    in_groups_ = groups_are_cheaper(costs);
    asks_ = scene.frame() == 1 || possible_gain_ns_ > min_return * waiting_ns(costs, in_groups_);
    asked_ = 0;
    covered_.begin_frame(scene);
    round_gain_ns_ = possible_gain_ns_ = 0.0;
    rounds_ = 0;
    has_to_ = false;
  }

  [[nodiscard]] Action predict(FrameScene& scene, const ReachedNode& reached) override {
    const NodeRef n = reached.ref;
    work_.note_visited(n);
    const Action action = predict_coherent(scene, n, Coherence::mended);
    if (action == Action::refine) return action;
    const bool is_fine = scene.is_fine(n, 1.0);
    const Action unasked = is_fine ? Action::draw : Action::refine;
    if (rounds_ == max_rounds) return unasked;
    const double gain = gain_ns(scene, n);
    if (!(gain > 0.0)) return unasked;
    possible_gain_ns_ += gain;
    if (!asks_) return unasked;
    round_gain_ns_ += gain;
    // The node is drawn only because little of it was visible, which has to be checked in every frame.
    has_to_ = has_to_ || (action == Action::stop && !is_fine);
    note_asked(scene, n);
    return action;
  }

  bool end_round(const FrameScene& scene, std::size_t) override {
    const bool pays = has_to_ || round_gain_ns_ > waiting_ns(scene.options().costs, false);
    round_gain_ns_ = 0.0;
    has_to_ = false;
    ++rounds_;
    return pays;
  }

  void note_drawn(const FrameScene& scene, NodeRef n) override {
    work_.note_drawn(scene, n);
    covered_.note_drawn(scene, n);
  }
  void note_answer(const FrameScene&, NodeRef n, bool visible) override {
    groups_.note_answer(n, visible);
    const Memory& memory = memory_[n];
    if (memory.last == LastSight::visible) rates_.note_visible(memory.covered, memory.frames, !visible);
    if (memory.last == LastSight::outside) rates_.note_new(memory.covered, !visible);
  }
  void end_frame(const FrameScene& scene) override {
    work_.end_frame(scene);
    last_asked_ = asked_;
  }

  [[nodiscard]] Asking asking() const noexcept override { return in_groups_ ? Asking::by_groups : Asking::by_rounds; }
  [[nodiscard]] std::size_t group(const FrameScene&, std::span<NodeRef> hidden) override {
    return groups_.group(hidden);
  }
  [[nodiscard]] double bias(const FrameScene& scene, const ReachedNode& n) const override {
    return static_cast<double>(scene.state(n.ref).bias);
  }

 private:
  struct Memory {
    std::uint32_t asked_frame = 0;  // frame of the last query, or in which it came into the frustum
    // The next three fields describe the last query.
    float covered = 0.0F;                // Covered::probability()
    float frames = 0.0F;                 // frames since asked_frame
    LastSight last = LastSight::hidden;  // what was known of the node
  };

  // Compares the costs for as many nodes as in the last frame.
  [[nodiscard]] bool groups_are_cheaper(const DeviceCosts& costs) const {
    const auto nodes = static_cast<double>(last_asked_);
    return nodes / usual_group * costs.query_ns < costs.batch_ns + nodes * costs.batch_item_ns + costs.readback_ns;
  }

  // Returns the expected savings of a query about the node.
  [[nodiscard]] double gain_ns(const FrameScene& scene, NodeRef n) {
    const DeviceCosts& costs = scene.options().costs;
    const ObjectFrame& view = scene.view_of(n);
    const double coverage = view.coverage(scene.node(n).box);
    const LastSight last = last_sight(scene, n);
    const double alone_ns = last == LastSight::visible ? costs.query_ns : costs.query_ns / usual_group;
    const double item_ns =
        std::max(in_groups_ ? alone_ns : costs.batch_item_ns, coverage * view.pixels() * costs.query_fragment_ns);
    const double draw_ns = draw_time_ns(costs, work_.of(scene, n, coverage));
    if (last == LastSight::hidden) return draw_ns - item_ns;
    const double covered = covered_.probability(coverage);
    if (last == LastSight::outside) {
      memory_[n].asked_frame = scene.frame();
      return rates_.of_new(covered) * draw_ns - item_ns;
    }
    const auto frames = static_cast<double>(scene.frame() - memory_[n].asked_frame);
    const double hidden = std::min(1.0, rates_.of_visible(covered) * frames);
    return hidden * draw_ns + bias_gain_ns(scene, n, coverage) - item_ns;
  }

  // Returns the savings of drawing the node instead of finer ones, for when little enough of it is visible.
  [[nodiscard]] double bias_gain_ns(const FrameScene& scene, NodeRef n, double coverage) const {
    if (scene.is_fine(n, 1.0)) return 0.0;
    const DeviceCosts& costs = scene.options().costs;
    const double refined_ns = draw_time_ns(costs, work_.refined(scene, n, coverage));
    return std::max(0.0, refined_ns - draw_time_ns(costs, own_work(scene, n, coverage)));
  }

  void note_asked(const FrameScene& scene, NodeRef n) {
    Memory& memory = memory_[n];
    memory.covered = static_cast<float>(covered_.probability(scene.view_of(n).coverage(scene.node(n).box)));
    memory.frames = static_cast<float>(scene.frame() - memory.asked_frame);
    memory.last = last_sight(scene, n);
    memory.asked_frame = scene.frame();
    ++asked_;
  }

  WorkBelow work_;
  PerNode<Memory> memory_;
  HiddenGroups groups_;
  HidingRates rates_;
  bool asks_ = true;  // in this frame
  bool in_groups_ = false;
  std::size_t asked_ = 0;               // nodes queried in this frame
  std::size_t last_asked_ = 1'000'000;  // nodes queried in the last frame; before the first, many
  Covered covered_;
  double possible_gain_ns_ = 0.0;  // in this frame so far, whether it queries or not
  double round_gain_ns_ = 0.0;     // in this round so far
  bool has_to_ = false;            // make the round, whatever it saves
  int rounds_ = 0;                 // in this frame
};

}  // namespace

std::unique_ptr<Policy> make_batch_policy() { return std::make_unique<BatchPolicy>(); }

}  // namespace occlod::hlod
