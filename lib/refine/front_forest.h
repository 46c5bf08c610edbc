// How fronts grow and shrink along the forest.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "refine/front_evaluation.h"

namespace occlod {

// A node is reached when it is a root or its parent has been descended; on a front is what is reached or applied.
class FrontForest {
 public:
  explicit FrontForest(FrontEvaluation& evaluation) : evaluation_(evaluation) {}

  // What refinement from scratch has applied, on an empty front.
  void adopt_splits(std::uint32_t object);
  // Then, where what is hidden is marked: descends from the roots to what matters no more than `level`.
  void adopt_forest(std::uint32_t object, float level);

  // Reaches the children of s and evaluates them; the result is valid until the next call. Throws Error for a file that
  // lies about its forest.
  std::span<const Front::Index> descend(std::uint32_t object, SplitId s);
  // Gives up descending nodes that are hidden or whose errors are no larger than `least`.
  void close(std::uint32_t object, float least);

 private:
  void reach(std::uint32_t object, SplitId s, SplitId parent, std::uint16_t level);
  void reach_children(std::uint32_t object, SplitId s);
  [[nodiscard]] bool is_closable(const Front& front, Front::Index k, float least) const;
  bool close_one(std::uint32_t object, SplitId s, float least);

  FrontEvaluation& evaluation_;
  std::vector<Front::Index> reached_, found_;
  std::vector<SplitId> open_, level_;  // scratch
};

}  // namespace occlod
