// Strategy::chc_plus: CHC++ (Mattausch, Bittner and Wimmer, "CHC++: Coherent Hierarchical Culling Revisited", 2008).
#include "hlod/draw/hidden_groups.h"
#include "hlod/draw/per_node.h"
#include "hlod/draw/policy.h"
#include "hlod/draw/work_below.h"

namespace occlod::hlod {
namespace {

constexpr std::uint32_t least_wait = 5, most_wait = 10;  // frames between questions about visible leaves (sec. 4.1)
constexpr int deepest = 3;                               // levels down to which boxes are refined (sec. 4.3)
constexpr double most_area = 1.4;                        // of them, relative to the node's

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
    memory.next_question = scene.frame() + wait(scene, n, least_wait);
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
    const double limit = most_area * box_area(scene.node(n).box);
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
    return least + static_cast<std::uint32_t>(seed % (most_wait - least + 1));
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

}  // namespace

std::unique_ptr<Policy> make_grouping_policy() { return std::make_unique<GroupingPolicy>(); }

}  // namespace occlod::hlod
