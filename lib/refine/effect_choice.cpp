#include "occlod/effects/effect_choice.h"

#include "refine/forecast.h"

namespace occlod {

std::string_view name_of(OcclusionEffort effort) noexcept {
  switch (effort) {
    case OcclusionEffort::none:
      return "none";
    case OcclusionEffort::subtrees:
      return "subtrees";
    case OcclusionEffort::renewed_subtrees:
      return "renewed-subtrees";
    case OcclusionEffort::stars:
      return "stars";
    case OcclusionEffort::renewed_stars:
      break;
  }
  return "renewed-stars";
}

RefineOptions EffectChoice::with(RefineOptions options) const {
  const bool renewed = effort == OcclusionEffort::renewed_subtrees || effort == OcclusionEffort::renewed_stars;
  options.occluder.splits.clear();
  if (!renewed) options.occluder.splits.push_back(single_occluder_splits(options.budget));
  options.queries.ask_stars = effort == OcclusionEffort::stars || effort == OcclusionEffort::renewed_stars;
  options.queries.level_step = level_step;
  options.occluder.retest_hidden = renewed;
  options.queries.final_check = false;
  options.effects = objects;
  return options;
}

}  // namespace occlod
