// When the occluder is drawn anew.
#pragma once

#include <algorithm>
#include <cstddef>

#include "occlod/refine/refiner.h"

namespace occlod {

// How far refinement has come.
struct Growth {
  std::size_t splits = 0;     // applied
  std::size_t triangles = 0;  // more than the base meshes have
};

// Either at given numbers of applied splits or, where none are given, when the mesh has grown by a factor since the
// last one and some split has moved its surface far enough to be worth it. So the work of drawing is a geometric series
// whose sum is little more than its last member.
class OccluderSteps {
 public:
  void begin(const RefineOptions& options) {
    options_ = &options;
    next_ = 0;
    last_ = {};
    moved_px_ = 0.0F;
  }

  void split_applied(float quadric_error_px) { moved_px_ = std::max(moved_px_, quadric_error_px); }

  [[nodiscard]] bool due(const Growth& now) const {
    const std::vector<std::uint32_t>& given = options_->occluder.splits;
    if (!given.empty()) return next_ < given.size() && now.splits >= given[next_];
    return now.triangles >= std::max(first_triangles, factor * last_.triangles) && moved_px_ >= least_move_px;
  }

  void drawn(const Growth& now) {
    if (!options_->occluder.splits.empty())
      while (due(now)) ++next_;
    last_ = now;
    moved_px_ = 0.0F;
  }
  // When it was drawn last.
  [[nodiscard]] const Growth& last() const noexcept { return last_; }

 private:
  static constexpr std::size_t first_triangles = 128;
  static constexpr std::size_t factor = 6;
  static constexpr float least_move_px = 1.0F;

  const RefineOptions* options_ = nullptr;
  std::size_t next_ = 0;  // of the given ones
  Growth last_;
  float moved_px_ = 0.0F;  // since then
};

}  // namespace occlod
