// Which effects are on in a view, and why.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "occlod/effects/calibration.h"
#include "occlod/refine/refiner.h"

namespace occlod {

// How much is asked about occlusion: about subtrees, or also about the stars of splits; with one occluder that is drawn
// after a thirty-second of the splits, or with new ones at parts of the budget (renewed).
enum class OcclusionEffort : std::uint8_t { none, subtrees, renewed_subtrees, stars, renewed_stars };
// Number of efforts.
inline constexpr std::size_t occlusion_effort_count = 5;
// As reports call it, e.g. "renewed-stars".
[[nodiscard]] std::string_view name_of(OcclusionEffort effort) noexcept;

// Which effects are on. The same choice, view, options and objects give the same mesh.
struct EffectChoice {
  OcclusionEffort effort = OcclusionEffort::none;  // how much is asked
  std::optional<std::size_t> backend;              // index into those given; none where nothing is asked
  std::uint32_t level_step = 1;                    // queries about subtrees on every n-th forest level
  std::vector<ObjectEffects> objects;              // by object

  // `options` with this choice in place of options.occluder but its mode, of options.queries but its proxy, and of
  // options.effects.
  [[nodiscard]] RefineOptions with(RefineOptions options) const;

  friend bool operator==(const EffectChoice&, const EffectChoice&) = default;
};

// Number of counts in FinerCounts.
inline constexpr std::size_t finer_count_size = 9;
// How many splits what is visible has down to half of the error at which the budget ends, to a quarter, and so on:
// relative to those down to that error itself, so the first is 1 and they rise.
using FinerCounts = std::array<double, finer_count_size>;

// How much a mesh fills the image.
struct Coverage {
  double layers = 1.0;        // fragments for each pixel of the image
  double front_layers = 1.0;  // of these, of triangles that face the eye: only those are in occluders
  double front_share = 1.0;   // of the triangles, in [0, 1]
};

// How much of a view is hidden, estimated from a sample of what refinement without occlusion would visit.
struct HiddenShares {
  std::size_t visits = 0;      // nodes sampled
  std::size_t splits = 0;      // of these, splits that would be applied
  double visits_hidden = 0.0;  // share of the nodes that are below a hidden subtree, in [0, 1]
  double splits_hidden = 0.0;  // share of the splits whose subtree is hidden, in [0, 1]
  double stars_hidden = 0.0;   // share of the splits whose own star is hidden, in [splits_hidden, 1]
  FinerCounts finer{1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0};  // of the splits that are not hidden
  Coverage coverage;                                                      // of the mesh that hides
};

// What one effort with one backend is expected to cost and give. The smallest score is chosen.
struct EffortForecast {
  OcclusionEffort effort = OcclusionEffort::none;  // how much would be asked
  std::optional<std::size_t> backend;              // index into those given; none where nothing is asked
  double frame_ms = 0.0;                           // refinement, occlusion and drawing
  double occlusion_ms = 0.0;                       // of these, occluders and queries
  double error = 1.0;                              // relative to that without occlusion at the same budget
  // Time to error: the smaller the better.
  [[nodiscard]] double score() const noexcept { return frame_ms * error; }
};

// A frame as it is expected.
struct FrameForecast {
  double triangles = 0.0;  // of the refined mesh
  double ms = 0.0;         // refinement, occlusion and drawing
};

// What was chosen for a view and why.
struct EffectReport {
  EffectChoice choice;                    // what was on
  std::vector<EffortForecast> forecasts;  // of everything that could have been chosen; first without occlusion
  HiddenShares ahead;                     // sampled before refinement, hidden by a coarse mesh
  std::optional<HiddenShares> back;       // sampled after an earlier view, hidden by its refined mesh
  bool looked_ahead = false;              // `ahead` is of this view
  bool looked_back = false;               // `back` is of this view
  bool held = false;                      // another choice scores better, but not by enough: update() keeps the one
                                          // before, refine() queries nothing
  double look_ms = 0.0;                   // measured time of both samples in this view
  // What a frame without occlusion would take for the forecast error of the choice, to compare with chosen()->frame_ms.
  FrameForecast same_error_without;
  std::vector<ObjectEffectStats> objects;  // by object: what the tests did

  // The forecast of the choice; null before the first view.
  [[nodiscard]] const EffortForecast* chosen() const noexcept {
    const auto found = std::find_if(forecasts.begin(), forecasts.end(), [this](const EffortForecast& forecast) {
      return forecast.effort == choice.effort && forecast.backend == choice.backend;
    });
    return found == forecasts.end() ? nullptr : &*found;
  }
};

}  // namespace occlod
