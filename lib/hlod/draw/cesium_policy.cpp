// Strategy::cesium: the rule of cesium-native. A node that wants to be refined is asked about; hidden ones, and new
// ones of which nothing is known yet, are drawn as they are. Answers are for the next frame. There queries outlive a
// frame, so the answers are there when the next begins; ours end with it, so those that are late are waited for at its
// end, where nothing else is delayed.
#include "hlod/draw/per_node.h"
#include "hlod/draw/policy.h"

namespace occlod::hlod {
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
