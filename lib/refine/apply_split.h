// How a split is applied with all that it needs, from scratch and from frame to frame alike.
#pragma once

#include "refine/queue.h"
#include "refine/refined_scene.h"

namespace occlod {

// False when there is no room for the split at its priority with what it forces; true also when it is applied already
// or steps back. The loop tells by which factor the priority sinks and takes what steps back, makes room by taking some
// split back or says that it cannot, and applies:
//   float forced_weight(const Entry&, const Cut::Closure&);  // see Importance::forced_weight
//   bool step_back(const Entry&);  // with Culling::star, once: false when it is its turn all the same
//   bool make_room(float turn_priority, float priority);  // at which its turn came, and with what it forces
//   void apply_closure(const Entry&, const Cut::Closure&);
template <typename Loop>
bool apply_split(const RefinedScene& scene, Entry& entry, Loop& loop) {
  CutSet& cuts = *scene.cuts;
  const RefineOptions* const options = scene.options;
  if (cuts[entry.object].applied(entry.split)) return true;
  const float turn_priority = entry.priority;
  Cut::Closure closure = cuts.closure(entry.object, entry.split);
  if (options->priority.culling == Culling::star && !entry.weighed) {
    const float weight = loop.forced_weight(entry, closure);
    entry.weighed = true;
    entry.priority *= weight;
    if (weight != 1.0F && loop.step_back(entry)) return true;
  }
  while (cuts.triangle_count() + closure.triangles > options->budget) {
    if (!loop.make_room(turn_priority, entry.priority)) return false;
    closure = cuts.closure(entry.object, entry.split);
  }
  loop.apply_closure(entry, closure);
  return true;
}

}  // namespace occlod
