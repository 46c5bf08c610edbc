// Predicts the time and error of a view from counts and the calibration.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "occlod/auto_refiner.h"
#include "refine/tuning.h"

namespace occlod {

// Error, relative to no occlusion, when a share of the triangles is freed: the budget then reaches down to where what
// is visible has 1 / (1 - hidden) times as many splits. `growth`: HiddenShares::growth, taken to hold for each halving.
[[nodiscard]] double error_with(double hidden, double growth);
// The other way round: relative to no occlusion, the triangles that are needed for this error.
[[nodiscard]] double triangles_for(double error, double growth);

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

struct Prospect {
  Way way = Way::from_scratch;
  FrameCounts counts;
  std::optional<FrameCounts> with;  // measured in views near this one that asked
  double coarse_layers = 1.0;       // Coverage::front_layers of the mesh of a look ahead
  HiddenShares shares;              // found with the refined mesh as the occluder
  double query_rate = 0.0;          // per triangle of the mesh
  double error_px = 1.0;            // that a picture without occlusion is expected to have
};

// A tenth of a pixel is not seen. It is added to errors in squares, so that smaller errors are hardly better.
inline constexpr double unseen_error_px = 0.1;
// Returns the expected error of a picture in pixels when refinement ends at nodes with an error of `level_px` and the
// share `hidden` of what it applies is hidden.
[[nodiscard]] double picture_error_px(double level_px, double hidden);

[[nodiscard]] double frame_ms_without(const Calibration& calibration, const FrameCounts& counts);
// Converts counts of a view with occlusion into those of the same view without it.
[[nodiscard]] FrameCounts counts_without(const FrameCounts& with, const HiddenShares& shares);
// Without occlusion first, then with every backend.
[[nodiscard]] std::vector<EffectForecast> forecasts(const Calibration& calibration, const Prospect& prospect);
// Without occlusion, at the forecast error of `chosen`: by the law of error_with() error falls with the b-th power of
// the number of triangles. No more than full_triangles.
[[nodiscard]] FrameForecast same_error_without(const Calibration& calibration, const Prospect& prospect,
                                               const EffectForecast& chosen, std::size_t full_triangles);

// How many splits the hidden answers of one region have freed. level_px: the error at which the budget ends.
[[nodiscard]] double splits_freed(const ObjectEffectStats::Region& region, double level_px, double growth);
// What one more split is worth, ns: its share of the frame.
[[nodiscard]] double split_worth_ns(const Calibration& calibration, const FrameCounts& counts);

// Number of triangles that a look ahead adds to the base meshes.
inline constexpr std::size_t coarse_triangles = 160;
// Used until views that ask have been counted: medians of the shipped scenes at 10,000 triangles.
[[nodiscard]] double usual_query_rate(Way way) noexcept;
// Likewise, scaled to a budget.
[[nodiscard]] FrameCounts usual_counts(Way way, std::size_t budget, const View& view, double far_share) noexcept;
// Returns the share of visits that miss the caches, from the number of splits of all hierarchies.
[[nodiscard]] double far_share(std::size_t splits) noexcept;
// `options` with a choice in place of options.effects, and of what the method asks and draws: with these a plain
// Refiner gives the same mesh. `tuning`: of the last call, used again where it is the same.
[[nodiscard]] RefineOptions with_choice(RefineOptions options, const EffectChoice& choice,
                                        std::shared_ptr<const Tuning>& tuning);

}  // namespace occlod
