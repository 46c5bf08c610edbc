// What both ways of refinement work on.
#pragma once

#include <span>

#include "refine/cut_set.h"
#include "occlod/refine/refiner.h"
#include "refine/importance.h"
#include "refine/effect_gate.h"
#include "refine/occlusion_queries.h"

namespace occlod {

// One view of all objects. Everything outlives the call that it is given to.
struct RefinedScene {
  std::span<const RefineObject> objects;
  std::span<const ObjectView> views;
  std::span<Importance> importances;
  CutSet* cuts = nullptr;
  EffectGate* gate = nullptr;
  OcclusionQueries* queries = nullptr;
  const View* view = nullptr;
  const RefineOptions* options = nullptr;

  [[nodiscard]] const Hierarchy& hierarchy(std::uint32_t object) const { return cuts->hierarchy(object); }
};

}  // namespace occlod
