// Which effects are on in a view, and why.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "occlod/effects/calibration.h"
#include "occlod/refine/refiner.h"

namespace occlod {

// How much is asked about occlusion. One occluder after a thirty-second of the splits, or whenever the mesh has changed
// enough; questions about subtrees, or about the stars of splits as well.
enum class OcclusionEffort : std::uint8_t { none, subtrees, renewed_subtrees, stars, renewed_stars };
inline constexpr std::size_t occlusion_effort_count = 5;
[[nodiscard]] std::string_view name_of(OcclusionEffort effort) noexcept;

// A choice is data: the same choice, view and objects give the same mesh.
struct EffectChoice {
  OcclusionEffort effort = OcclusionEffort::none;
  std::optional<std::size_t> backend;  // of those given; none where nothing is asked
  std::uint32_t level_step = 1;        // questions about subtrees on every n-th level
  std::vector<ObjectEffects> objects;  // by object

  // `options` with this choice in place of what they say about effects. Occluders, questions and cones only: budget,
  // tolerance, weights, mode and proxies stay.
  [[nodiscard]] RefineOptions with(RefineOptions options) const;

  friend bool operator==(const EffectChoice&, const EffectChoice&) = default;
};

// What a sample of refinement without occlusion says about a view.
struct HiddenShares {
  std::size_t visits = 0;      // nodes sampled
  std::size_t splits = 0;      // of these, splits that would be applied
  double visits_hidden = 0.0;  // share of the nodes that are below a hidden subtree
  double splits_hidden = 0.0;  // share of the splits whose subtree is hidden
  double stars_hidden = 0.0;   // share of the splits whose own star is hidden: no less
  double growth = 1.0;         // triangles that it takes to halve the errors of what is not hidden, of those that are
                               // there: 1 on a mesh that goes on for ever, less where it ends
};

// One way to go, before it is gone. The smallest score is chosen.
struct EffortForecast {
  OcclusionEffort effort = OcclusionEffort::none;
  std::optional<std::size_t> backend;
  double frame_ms = 0.0;      // refinement, occlusion and drawing
  double occlusion_ms = 0.0;  // of these, occluders and questions
  double error = 1.0;         // of what it is without occlusion, at the same budget
  [[nodiscard]] double score() const noexcept { return frame_ms * error; }
};

struct EffectReport {
  EffectChoice choice;
  std::vector<EffortForecast> forecasts;
  HiddenShares ahead;                // by a coarse mesh before refinement
  std::optional<HiddenShares> back;  // by the refined mesh of an earlier view
  bool looked_ahead = false;         // in this view
  bool looked_back = false;
  bool held = false;             // update(): another would score better, but not by enough to change
  double look_ms = 0.0;          // measured: what both took
  double saved_triangles = 0.0;  // that refinement without occlusion would need more for the same error, forecast
  double saved_ms = 0.0;         // and what those would take
  std::vector<ObjectEffectStats> objects;  // what came of it
};

}  // namespace occlod
