// Predicts the time and error of a view from counts and the calibration.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "occlod/auto_refiner.h"

namespace occlod {

// Error, relative to no occlusion, when a share of the triangles is freed: the budget then reaches down to where what
// is visible has 1 / (1 - hidden) times as many splits. A power of two between the counts that are known.
[[nodiscard]] double error_with(double hidden, const FinerCounts& finer);
// The other way round: relative to no occlusion, the triangles that are needed for this error.
[[nodiscard]] double triangles_for(double error, const FinerCounts& finer);

// How a view is refined: from the base meshes, or from the frame before (Refiner::update()).
enum class Way : std::uint8_t { from_scratch, going_on };

// What refining and drawing a view without occlusion takes, in counts.
struct FrameCounts {
  double triangles = 0.0;
  double splits = 0.0;       // applied; from frame to frame also merged
  double kept_splits = 0.0;  // from frame to frame: applied in the whole mesh
  double visits = 0.0;
  double pixels = 0.0;
  double far_share = 0.0;  // share of the visits that miss the caches
  double layers = 1.0;     // fragments for each pixel
};

// Queries per triangle of the mesh, by effort.
using QueryRates = std::array<double, occlusion_effort_count>;

struct Prospect {
  Way way = Way::from_scratch;
  FrameCounts counts;
  std::array<std::optional<FrameCounts>, occlusion_effort_count> known;  // measured in views near this one, by effort
  HiddenShares ahead;                                                    // found with an early occluder
  HiddenShares back;                                                     // found with the refined mesh as the occluder
  QueryRates rates{};
  double error_px = 1.0;  // that a picture without occlusion is expected to have
};

// A tenth of a pixel is not seen: smaller errors are no better. Added in squares.
inline constexpr double unseen_error_px = 0.1;
// The error of a picture where refinement ends at nodes of this error, and so much of what it applies is hidden.
[[nodiscard]] double picture_error_px(double level_px, double hidden);

[[nodiscard]] double frame_ms_without(const Calibration& calibration, const FrameCounts& counts);
// The same view without occlusion, where it has only been seen with.
[[nodiscard]] FrameCounts counts_without(const FrameCounts& with, const HiddenShares& shares);
// Without occlusion first, then every effort with every backend. From frame to frame only the largest effort: every
// frame draws an occluder, and without star queries no applied split would be tested again.
[[nodiscard]] std::vector<EffortForecast> forecasts(const Calibration& calibration, const Prospect& prospect);
// Without occlusion, at the forecast error of `chosen`: by the law of error_with() error falls with the b-th power of
// the number of triangles. No more than full_triangles.
[[nodiscard]] FrameForecast same_error_without(const Calibration& calibration, const Prospect& prospect,
                                               const EffortForecast& chosen, std::size_t full_triangles);

// How many splits the hidden answers of one region have freed. level_px: the error at which the budget ends.
[[nodiscard]] double splits_freed(const ObjectEffectStats::Region& region, double level_px, const FinerCounts& finer);
// What one more split is worth, ns: its share of the frame.
[[nodiscard]] double split_worth_ns(const Calibration& calibration, const FrameCounts& counts);

// What a look ahead adds to the base meshes.
inline constexpr std::size_t coarse_triangles = 160;
// Used until views with an effort have been counted: medians of the shipped scenes at 10,000 triangles.
[[nodiscard]] QueryRates usual_query_rates(Way way) noexcept;
// Likewise, scaled to a budget.
[[nodiscard]] FrameCounts usual_counts(Way way, std::size_t budget, const View& view, double far_share) noexcept;
// The share of visits that miss the caches, by the number of splits of all hierarchies.
[[nodiscard]] double far_share(std::size_t splits) noexcept;
// The number of applied splits at which an effort with a single occluder draws it.
[[nodiscard]] std::uint32_t single_occluder_splits(std::size_t budget) noexcept;

}  // namespace occlod
