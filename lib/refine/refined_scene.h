// Holds what both ways of refinement work on, and applies splits for both.
#pragma once

#include <span>

#include "occlod/hierarchy.h"
#include "occlod/refiner.h"
#include "refine/cut.h"
#include "refine/importance.h"
#include "refine/occlusion_queries.h"
#include "refine/queue.h"
#include "refine/tuning.h"

namespace occlod {

// Refers to one view of all objects. Everything must outlive the call that it is given to.
struct RefinedScene {
  std::span<const RefineObject> objects;
  std::span<const ObjectView> views;
  std::span<Importance> importances;
  CutSet* cuts = nullptr;
  EffectGate* gate = nullptr;
  OcclusionQueries* queries = nullptr;
  const View* view = nullptr;
  const RefineOptions* options = nullptr;
  unsigned threads = 1;  // that may work on it

  [[nodiscard]] const Hierarchy& hierarchy(std::uint32_t object) const { return cuts->hierarchy(object); }
};

// Applies a split with all that it needs, from scratch and from frame to frame alike. Returns false when there is no
// room for the split at its priority with what it forces; true also when it is applied already or steps back. The loop
// weighs the priority, takes entries that step back, makes room by taking back some split or says that it cannot, and
// applies:
//   float forced_weight(const Entry&, const Cut::Closure&);  // see Importance::forced_weight()
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
  if (tuning_of(*options).culling == Culling::star && !entry.weighed) {
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

// Throws Error when the forest parent of s is not `parent`: a file with a wrong forest could be walked without an end.
void require_parent(const Hierarchy& hierarchy, SplitId s, SplitId parent);

}  // namespace occlod
