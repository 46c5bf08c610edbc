// Strategy::sw and sw_b: hierarchical stop-and-wait (Bittner and others 2004; SW-eps and SW-eps^q in Charalambos 2006).
#include "hlod/draw/policy.h"

namespace occlod::hlod {
namespace {

class WaitingPolicy : public Policy {
 public:
  explicit WaitingPolicy(bool biased) : biased_(biased) {}
  [[nodiscard]] Action predict(FrameScene&, const ReachedNode&) override { return Action::delay; }
  [[nodiscard]] bool biased() const noexcept override { return biased_; }
  [[nodiscard]] bool waits() const noexcept override { return true; }

 private:
  bool biased_;
};

}  // namespace

std::unique_ptr<Policy> make_waiting_policy(bool biased) { return std::make_unique<WaitingPolicy>(biased); }

}  // namespace occlod::hlod
