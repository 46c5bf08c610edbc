// Explains what `--occlusion auto` did.
#pragma once

#include <string>
#include <vector>

#include "json_output.h"
#include "occlod/auto_refiner.h"
#include "occlod/refiner.h"
#include "occlod/scene.h"

namespace occlod::tool {

// Returns, for the last view, the choice, its forecasts, what was seen to be hidden, and every object's effects.
[[nodiscard]] Json to_json(const AutoRefiner& refiner);

// Prints this for people: per effect and object, whether it was on, what it cost and what it saved.
void print_explanation(const AutoRefiner& refiner, const RefineStats& stats, const std::vector<LoadedObject>& objects);

}  // namespace occlod::tool
