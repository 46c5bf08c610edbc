// How a split is applied with all that it needs, from scratch and from frame to frame alike.
#pragma once

#include "priority/queue.h"
#include "refine/refined_scene.h"

namespace occlod {

// Culling::star: a split that forces others which nobody sees steps back in the queue, once. `weight`: see
// Importance::forced_weight.
inline bool steps_back(Entry& entry, float weight, Queue& queue) {
  entry.weighed = true;
  entry.priority *= weight;
  if (weight == 1.0F || queue.would_be_next(entry)) return false;
  queue.push(entry);
  return true;
}

// False when there is no room for the split at its priority with what it forces; true also when it is applied already
// or steps back. The loop tells by which factor the priority sinks, makes room by taking some split back or says that
// it cannot, and applies:
//   float forced_weight(const Entry&, const Cut::Closure&);
//   bool make_room(float turn_priority, float priority);  // at which its turn came, and with what it forces
//   void apply_closure(const Entry&, const Cut::Closure&);
template <typename Loop>
bool apply_split(const RefinedScene& scene, Queue& queue, Entry& entry, Loop& loop) {
  CutSet& cuts = *scene.cuts;
  const RefineOptions* const options = scene.options;
  if (cuts[entry.object].applied(entry.split)) return true;
  const float turn_priority = entry.priority;
  Cut::Closure closure = cuts.closure(entry.object, entry.split);
  if (options->priority.culling == Culling::star && !entry.weighed &&
      steps_back(entry, loop.forced_weight(entry, closure), queue))
    return true;
  while (cuts.triangle_count() + closure.triangles > options->budget) {
    if (!loop.make_room(turn_priority, entry.priority)) return false;
    closure = cuts.closure(entry.object, entry.split);
  }
  loop.apply_closure(entry, closure);
  return true;
}

}  // namespace occlod
