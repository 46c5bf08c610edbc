// When the occluder is drawn anew.
#pragma once

#include <algorithm>
#include <cstddef>

#include "occlod/refine/refiner.h"

namespace occlod {

// Either at given numbers of applied splits or, where none are given, when the mesh has grown by a factor since the
// last one and some split has moved its surface far enough to be worth it. So the work of drawing is a geometric series
// whose sum is at most a few times that of the last.
class OccluderSteps {
 public:
  void begin(const RefineOptions& options) {
    options_ = &options;
    next_ = 0;
    splits_at_last_ = 0;
    moved_px_ = 0.0F;
  }

  void split_applied(float quadric_error_px) { moved_px_ = std::max(moved_px_, quadric_error_px); }

  [[nodiscard]] bool due(std::size_t splits) const {
    if (options_->occluder_splits)
      return next_ < options_->occluder_splits->size() && splits >= (*options_->occluder_splits)[next_];
    return splits >= std::max(first_splits, growth * splits_at_last_) && moved_px_ >= least_move_px;
  }

  void drawn(std::size_t splits) {
    if (options_->occluder_splits)
      while (due(splits)) ++next_;
    splits_at_last_ = splits;
    moved_px_ = 0.0F;
  }
  [[nodiscard]] std::size_t splits_at_last() const noexcept { return splits_at_last_; }

 private:
  static constexpr std::size_t first_splits = 64;
  static constexpr std::size_t growth = 6;
  static constexpr float least_move_px = 1.0F;

  const RefineOptions* options_ = nullptr;
  std::size_t next_ = 0;  // of the given ones
  std::size_t splits_at_last_ = 0;
  float moved_px_ = 0.0F;  // since then
};

}  // namespace occlod
