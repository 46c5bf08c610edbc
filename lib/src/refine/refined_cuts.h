// What both ways of refinement work on.
#pragma once

#include <span>

#include "cut/cut.h"
#include "occlod/refine/refiner.h"
#include "priority/importance.h"
#include "queries/effect_gate.h"

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
