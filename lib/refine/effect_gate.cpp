#include "refine/effect_gate.h"

#include <string>

#include "occlod/core/error.h"

namespace occlod {

RegionGrid::RegionGrid(const Box& box) : min_(box.min) {
  constexpr auto cells = static_cast<float>(effect_regions_per_axis);
  for (int axis = 0; axis < 3; ++axis) {
    const float extent = box.max[axis] - box.min[axis];
    cells_per_unit_[axis] = extent > 0.0F ? cells / extent : 0.0F;
  }
}

void EffectGate::begin(std::span<const RefineObject> objects, const RefineOptions& options) {
  if (!options.effects.empty() && options.effects.size() != objects.size())
    throw Error({"effects", "", "are given for " + std::to_string(options.effects.size()) + " objects",
                 "give none or one for each of " + std::to_string(objects.size())});
  objects_.clear();
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const ObjectEffects effects = options.effects.empty() ? ObjectEffects{} : options.effects[i];
    objects_.push_back({RegionGrid(objects[i].hierarchy->box()), effects.occlusion ? effects.regions : 0,
                        effects.cones && !objects[i].two_sided});
  }
  stats_.assign(objects.size(), {});
}

}  // namespace occlod
