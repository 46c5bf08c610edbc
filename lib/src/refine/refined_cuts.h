// What both ways of refinement work on.
#pragma once

#include <span>

#include "cut.h"
#include "effect_gate.h"
#include "importance.h"
#include "occlod/refine/refiner.h"

namespace occlod {

// By object.
struct RefinedCuts {
  std::span<const RefineObject> objects;
  std::span<Cut> cuts;
  std::span<const ObjectView> views;
  std::span<Importance> importances;
  EffectGate* gate = nullptr;  // what works on each object
  const View* view = nullptr;
};

}  // namespace occlod
