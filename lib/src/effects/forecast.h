// What a view will cost and how good it will be, by counts and the calibration.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "occlod/effects/effect_choice.h"

namespace occlod {

// Error against the share of triangles that are freed, h: (1 - h)^(0.4 b). Surface error falls with one over the number
// of triangles (b = 1) while the mesh goes on, and faster where it comes to its end: halving it takes g times as many
// triangles more, b = log 2 / log(1 + g). The depth error of the picture, with its outlines, falls slower, and what is
// freed goes to what matters less than what has been refined already: 0.4, fitted to the shipped scenes.
[[nodiscard]] double error_with(double hidden, double growth);

// How a view is refined: from the base meshes, or from the frame before (Refiner::update()).
enum class Way : std::uint8_t { from_scratch, going_on };

// A view without occlusion, in counts.
struct FrameCounts {
  double triangles = 0.0;
  double splits = 0.0;       // applied, or going on taken back
  double kept_splits = 0.0;  // going on: that the mesh consists of
  double visits = 0.0;
  double pixels = 0.0;
  double far_share = 0.0;  // of the visits, to nodes that are not in the caches
};

// Questions for each triangle of the mesh, by effort.
using QueryRates = std::array<double, occlusion_effort_count>;

struct Prospect {
  Way way = Way::from_scratch;
  FrameCounts counts;
  std::array<std::optional<FrameCounts>, occlusion_effort_count> known;  // of views near this one, with an effort
  HiddenShares ahead;                                                    // by an occluder that is drawn early
  HiddenShares back;  // and by one that is drawn when the mesh is fine
  QueryRates rates{};
};

// The share of splits that an effort frees.
[[nodiscard]] double hidden_with(OcclusionEffort effort, const Prospect& prospect);
[[nodiscard]] double frame_ms_without(const Calibration& calibration, const FrameCounts& counts);
// Without occlusion first, then every effort with every backend. Going on only the largest: every frame draws an
// occluder, and without questions about stars nothing that is applied would be asked about again.
[[nodiscard]] std::vector<EffortForecast> forecasts(const Calibration& calibration, const Prospect& prospect);
// How many splits the hidden answers of one region have freed. level_px: see RefineStats.
[[nodiscard]] double splits_freed(const ObjectEffectStats::Region& region, double level_px);
// What one more split is worth, ns: its share of the frame.
[[nodiscard]] double split_worth_ns(const Calibration& calibration, const FrameCounts& counts);

// Until views with an effort have been counted: medians of the shipped scenes at 10,000 triangles.
[[nodiscard]] QueryRates usual_query_rates(Way way) noexcept;
// Likewise, of a budget.
[[nodiscard]] FrameCounts usual_counts(Way way, std::size_t budget, const View& view, double far_share) noexcept;
// Of hierarchies with so many splits.
[[nodiscard]] double far_share(std::size_t splits) noexcept;
// When the mesh has so many splits the occluder of an effort that draws one is drawn.
[[nodiscard]] std::uint32_t single_occluder_splits(std::size_t budget) noexcept;

}  // namespace occlod
