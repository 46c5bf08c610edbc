// Applied splits that could be given up for something better.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "refine/cut_set.h"
#include "refine/importance.h"

namespace occlod {

// Leaves of the cuts of all objects, the least important on top.
class Victims {
 public:
  void clear() noexcept;
  [[nodiscard]] bool gathered() const noexcept { return gathered_; }

  // Looks at every applied split. O(n).
  void gather(const CutSet& cuts, std::span<Importance> importances);

  struct Victim {
    std::uint32_t object = 0;
    SplitId split = no_id;
    float priority = 0.0F;  // as in Importance::Value; of splits that change nothing that is seen 0
    ScreenError error;
  };
  // Takes back the least important leaf, if that is worth less than `priority`.
  std::optional<Victim> take_back_below(float priority, CutSet& cuts, std::span<Importance> importances);

 private:
  void push(std::uint32_t object, SplitId s, Importance& importance);

  bool gathered_ = false;
  std::vector<Victim> heap_;
  std::vector<SplitId> leaves_;  // scratch, both of one object
  std::vector<Importance::Value> values_;
};

}  // namespace occlod
