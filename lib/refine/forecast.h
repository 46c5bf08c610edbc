// Predicts the time and error of a view from counts and the calibration.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "occlod/auto_refiner.h"

namespace occlod {

// Returns the error, relative to no occlusion, when a share of the triangles is freed: the budget then reaches down to
// where what is visible has 1 / (1 - hidden) times as many splits. Between the known counts the error is a power of the
// number of splits.
[[nodiscard]] double error_with(double hidden, const FinerCounts& finer);
// Returns the inverse: the number of triangles that this error needs, relative to no occlusion.
[[nodiscard]] double triangles_for(double error, const FinerCounts& finer);

// Selects how a view is refined: from the base meshes, or from the frame before (Refiner::update()).
enum class Way : std::uint8_t { from_scratch, going_on };

// Counts what refining and drawing a view takes, apart from occlusion.
struct FrameCounts {
  double triangles = 0.0;
  double splits = 0.0;       // applied; from frame to frame applied or merged
  double kept_splits = 0.0;  // from frame to frame: all applied ones
  double visits = 0.0;
  double pixels = 0.0;
  double far_share = 0.0;  // share of the visits that miss the caches
  double layers = 1.0;     // fragments per pixel
};

// Queries per triangle of the mesh, by effort.
using QueryRates = std::array<double, occlusion_effort_count>;

struct Prospect {
  Way way = Way::from_scratch;
  FrameCounts counts;
  std::array<std::optional<FrameCounts>, occlusion_effort_count> known;  // measured in views near this one, by effort
  HiddenShares ahead;                                                    // shares hidden by an early occluder
  HiddenShares back;                                                     // shares hidden by the refined mesh
  QueryRates rates{};
  double error_px = 1.0;  // expected error of a picture without occlusion
};

// A tenth of a pixel is not seen. It is added to errors in squares, so that smaller errors are hardly better.
inline constexpr double unseen_error_px = 0.1;
// Returns the expected error of a picture in pixels when refinement ends at nodes with an error of `level_px` and the
// share `hidden` of what it applies is hidden.
[[nodiscard]] double picture_error_px(double level_px, double hidden);

[[nodiscard]] double frame_ms_without(const Calibration& calibration, const FrameCounts& counts);
// Converts counts of a view with occlusion into those of the same view without it.
[[nodiscard]] FrameCounts counts_without(const FrameCounts& with, const HiddenShares& shares);
// Returns the forecast without occlusion first, then those of every effort with every backend. From frame to frame only
// renewed efforts are forecast, because every frame draws an occluder.
[[nodiscard]] std::vector<EffortForecast> forecasts(const Calibration& calibration, const Prospect& prospect);
// Forecasts a frame without occlusion that has the forecast error of `chosen`, with at most full_triangles triangles.
[[nodiscard]] FrameForecast same_error_without(const Calibration& calibration, const Prospect& prospect,
                                               const EffortForecast& chosen, std::size_t full_triangles);

// Returns how many splits the hidden answers of one region have freed. `level_px` is the error at which the budget
// ends.
[[nodiscard]] double splits_freed(const ObjectEffectStats::Region& region, double level_px, const FinerCounts& finer);
// Returns what one more split is worth, ns: its share of the frame.
[[nodiscard]] double split_worth_ns(const Calibration& calibration, const FrameCounts& counts);

// Number of triangles that a look ahead adds to the base meshes.
inline constexpr std::size_t coarse_triangles = 160;
// Returns the rates to use until views with an effort have been counted: medians of the shipped scenes at 10,000
// triangles.
[[nodiscard]] QueryRates usual_query_rates(Way way) noexcept;
// Returns the usual counts of the shipped scenes, scaled to a budget.
[[nodiscard]] FrameCounts usual_counts(Way way, std::size_t budget, const View& view, double far_share) noexcept;
// Returns the share of visits that miss the caches, from the number of splits of all hierarchies.
[[nodiscard]] double far_share(std::size_t splits) noexcept;
// Returns the number of applied splits at which an effort with a single occluder draws it.
[[nodiscard]] std::uint32_t single_occluder_splits(std::size_t budget) noexcept;

}  // namespace occlod
