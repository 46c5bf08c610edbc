// Strategy::simp: visibility predicted by the place in the queue (Charalambos 2006, sec. 5.2).
#include <algorithm>

#include "hlod/draw/policy.h"

namespace occlod::hlod {
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

}  // namespace occlod::hlod
