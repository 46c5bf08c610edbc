// Strategy::two_pass: as GPU-driven engines do (Haar & Aaltonen 2015; Nanite): draw what was visible, test everything
// else and what was drawn against that, draw what shows.
#include "hlod/draw/policy.h"

namespace occlod::hlod {
namespace {

class TwoPassPolicy : public Policy {
 public:
  void begin_frame(const FrameScene&) override { has_tested_ = false; }

  [[nodiscard]] Action predict(FrameScene& scene, const ReachedNode& n) override {
    const bool is_fine = scene.is_fine(n.ref, 1.0);
    if (has_tested_) return is_fine ? Action::draw : Action::refine;
    if (!scene.last(n.ref).visible) return Action::delay;
    return is_fine ? Action::stop : Action::refine;
  }
  bool end_round(const FrameScene&, std::size_t) override { return has_tested_ = true; }

  [[nodiscard]] bool biased() const noexcept override { return false; }
  [[nodiscard]] Asking asking() const noexcept override { return Asking::by_rounds; }

 private:
  bool has_tested_ = false;
};

}  // namespace

std::unique_ptr<Policy> make_two_pass_policy() { return std::make_unique<TwoPassPolicy>(); }

}  // namespace occlod::hlod
