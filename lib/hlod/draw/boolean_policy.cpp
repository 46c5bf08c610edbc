// Strategy::boolean: coherent hierarchical culling (Bittner and others 2004) as Gobetti & Marton 2005 use it;
// algorithms 1 to 4 in Charalambos 2006.
#include "hlod/draw/policy.h"

namespace occlod::hlod {
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

}  // namespace occlod::hlod
