// What nobody sees of the cut, and is applied all the same because something else needs it.
#pragma once

#include <cstdint>

#include "refine/cut.h"
#include "refine/front_evaluation.h"

namespace occlod {

// A split is charged, as far as its star is not seen, to those that remove faces of it, with what it needs itself: what
// removes a part f of its removed faces pays sqrt(f) of it. Were it f, several leaves would keep for good what none of
// them is worth; were it all, what is needed most would cost the most.
class UnseenNeeds {
 public:
  explicit UnseenNeeds(FrontEvaluation& evaluation) : evaluation_(evaluation) {}

  void begin_frame(std::uint32_t frame) noexcept { frame_ = frame; }

  // The factor by which the priority of an applied split sinks, in (0, 1]. O(what it needs directly), as what those
  // are charged with is known for some frames.
  [[nodiscard]] float weight_of_applied(std::uint32_t object, SplitId s);
  // Of closure.splits[0] once the closure is applied. O(closure).
  [[nodiscard]] float weight_of_closure(std::uint32_t object, const Cut::Closure& closure);

 private:
  // All of these count splits.
  [[nodiscard]] float needed_by(std::uint32_t object, SplitId s, int depth);
  [[nodiscard]] float needed_by_unapplied(std::uint32_t object, SplitId s);
  [[nodiscard]] float charge(std::uint32_t object, SplitId s, std::uint32_t own, std::uint32_t removed, int depth);
  [[nodiscard]] float below(std::uint32_t object, Front::Index k, int depth);
  [[nodiscard]] float unseen_part(std::uint32_t object, SplitId s);
  [[nodiscard]] float weight(float unseen) const;

  FrontEvaluation& evaluation_;
  std::uint32_t frame_ = 0;
};

}  // namespace occlod
