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

// Either at given numbers of applied splits or, where none are given, when the mesh has grown to a third of the budget,
// or to that divided by powers of some factor, and some split has moved its surface far enough to be worth it. So the
// work of drawing is a geometric series, and the last one but that of the final check still decides about most of the
// budget.
class OccluderSteps {
 public:
  // Where no numbers are given: of how many triangles the first is, and the next ones times how many.
  static constexpr double factor = 6.0;
  [[nodiscard]] static double first(double budget) {
    const double last = budget / last_part;
    const double least = std::clamp(last / factor, least_triangles, enough_triangles);
    double triangles = std::max(last, least);
    while (triangles >= factor * least) triangles /= factor;
    return triangles;
  }

  void begin(const RefineOptions& options) {
    options_ = &options;
    next_ = 0;
    next_triangles_ = first(static_cast<double>(options.budget));
    last_ = {};
    moved_px_ = 0.0F;
  }

  void split_applied(float quadric_error_px) { moved_px_ = std::max(moved_px_, quadric_error_px); }

  [[nodiscard]] bool due(const Growth& now) const {
    const std::vector<std::uint32_t>& given = options_->occluder.splits;
    if (!given.empty()) return next_ < given.size() && now.splits >= given[next_];
    return static_cast<double>(now.triangles) >= next_triangles_ && moved_px_ >= least_move_px;
  }

  void drawn(const Growth& now) {
    if (!options_->occluder.splits.empty())
      while (due(now)) ++next_;
    while (next_triangles_ <= static_cast<double>(now.triangles)) next_triangles_ *= factor;
    last_ = now;
    moved_px_ = 0.0F;
  }
  // When it was drawn last.
  [[nodiscard]] const Growth& last() const noexcept { return last_; }

 private:
  // That a first one has: at least; and where two of them are drawn anyway.
  static constexpr double least_triangles = 32.0, enough_triangles = 128.0;
  static constexpr double last_part = 3.0;  // of the budget, at the last of them
  static constexpr float least_move_px = 1.0F;

  const RefineOptions* options_ = nullptr;
  std::size_t next_ = 0;         // of the given ones
  double next_triangles_ = 0.0;  // where none are given
  Growth last_;
  float moved_px_ = 0.0F;  // since then
};

}  // namespace occlod
