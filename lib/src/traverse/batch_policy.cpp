// Strategy::batch: Coh(B)'s prediction, but what it would ask is counted together, in at most three rounds a frame.
// What goes into a round, and whether there is one, is decided by what it costs and saves, as in NOHC.
#include "traverse/hidden_groups.h"
#include "traverse/policy.h"
#include "traverse/work_below.h"

namespace occlod::hlod {
namespace {

constexpr int most_rounds = 3;
constexpr double usual_group = 4.0;  // nodes in a query, with those that have to be asked about again

class BatchPolicy : public Policy {
 public:
  void begin_frame(const FrameScene& scene) override {
    work_.begin_frame(scene);
    memory_.fit(scene);
    groups_.begin_frame(scene);
    in_groups_ = groups_are_cheaper(scene.options().costs);
    asked_ = 0;
    covered_ = gain_ns_ = 0.0;
    rounds_ = 0;
    has_to_ = false;
  }

  [[nodiscard]] Action predict(FrameScene& scene, const ReachedNode& reached) override {
    const NodeRef n = reached.ref;
    work_.note_visited(n);
    const Action action = predict_coherent(scene, n);
    if (action == Action::refine) return action;
    const bool is_fine = scene.is_fine(n, 1.0);
    const Action unasked = is_fine ? Action::draw : Action::refine;
    // Drawn only because little of it was visible: that has to be known anew in every frame.
    const bool must = scene.last(n).visible && !is_fine;
    if (rounds_ == most_rounds) return unasked;
    const double gain = gain_ns(scene, n);
    if (!must && !(gain > 0.0)) return unasked;
    gain_ns_ += std::max(gain, 0.0);
    has_to_ = has_to_ || must;
    memory_[n].asked_frame = scene.frame();
    ++asked_;
    return action;
  }

  // What a round costs beside its boxes: the device has nothing to do until the answers have been read.
  bool end_round(const FrameScene& scene, std::size_t) override {
    const DeviceCosts& costs = scene.options().costs;
    const bool pays = has_to_ || gain_ns_ > costs.batch_ns + costs.readback_ns + costs.submit_ns;
    gain_ns_ = 0.0;
    has_to_ = false;
    ++rounds_;
    return pays;
  }

  void note_drawn(const FrameScene& scene, NodeRef n) override {
    work_.note_drawn(scene, n);
    covered_ = covered_with(covered_, own_coverage(scene, n));
  }
  void note_answer(const FrameScene&, NodeRef n, bool visible) override { groups_.note_answer(n, visible); }
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
    std::uint32_t asked_frame = 0;
  };

  // For as many nodes as in the last frame.
  [[nodiscard]] bool groups_are_cheaper(const DeviceCosts& costs) const {
    const auto nodes = static_cast<double>(last_asked_);
    return nodes / usual_group * costs.query_ns < costs.batch_ns + nodes * costs.batch_item_ns + costs.readback_ns;
  }

  // What asking about the node is expected to save.
  [[nodiscard]] double gain_ns(const FrameScene& scene, NodeRef n) {
    const DeviceCosts& costs = scene.options().costs;
    const ObjectFrame& view = scene.view_of(n);
    const double coverage = view.coverage(scene.node(n).box);
    const LastSight last = last_sight(scene, n);
    const double alone_ns = last == LastSight::visible ? costs.query_ns : costs.query_ns / usual_group;
    const double item_ns =
        std::max(in_groups_ ? alone_ns : costs.batch_item_ns, coverage * view.pixels() * costs.query_fragment_ns);
    const double covered = cover_probability(covered_, coverage, scene.options().cover_model);
    double probability = occlusion_probability(covered, last);
    if (last == LastSight::outside) memory_[n].asked_frame = scene.frame();
    // The gain adds up over the levels and over the frames of the wait.
    if (last == LastSight::visible)
      probability *= static_cast<double>(scene.frame() - memory_[n].asked_frame) /
                     static_cast<double>(scene.hlod(n).level_count());
    return probability * draw_time_ns(costs, work_.of(scene, n, coverage)) - item_ns;
  }

  WorkBelow work_;
  PerNode<Memory> memory_;
  HiddenGroups groups_;
  bool in_groups_ = false;
  std::size_t asked_ = 0;               // nodes, in this frame
  std::size_t last_asked_ = 1'000'000;  // in the last; before the first, many
  double covered_ = 0.0;                // c_scr
  double gain_ns_ = 0.0;                // of the round so far
  bool has_to_ = false;                 // make the round, whatever it gains
  int rounds_ = 0;                      // in this frame
};

}  // namespace

std::unique_ptr<Policy> make_batch_policy() { return std::make_unique<BatchPolicy>(); }

}  // namespace occlod::hlod
