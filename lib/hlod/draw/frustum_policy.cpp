// Strategy::vfc.
#include "hlod/draw/policy.h"

namespace occlod::hlod {
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

}  // namespace occlod::hlod
