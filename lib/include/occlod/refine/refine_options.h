// What a caller asks of refinement. Options belong to a call and not to a Refiner, so that a program may change any of
// them from frame to frame, as a slider does; Refiner::update() starts from scratch by itself where it has to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "occlod/refine/object_effects.h"

namespace occlod {

// Which question decides that a split is applied.
enum class Culling {
  subtree,  // one, as in the paper: may the bounds of its subtree be seen?
  star,     // two: descend where the bounds of the subtree may be seen, apply where the split's own faces may be
};

// The bounds of a subtree that occlusion queries ask about.
enum class Proxy { sphere, box, cylinder };

// What the current mesh hides.
enum class OccluderMode {
  paper,        // whatever is behind its triangles as they are: where they bulge out of the true surface, too much
  conservative  // only what stays hidden wherever collapses may have moved the surface: nothing that the input shows,
                // if both sides of its triangles hide. For any kind of error bound. What hides are squares of 8x8
                // pixels. Replays all collapses of a hierarchy the first time, and so reads all of a mapped file
                // (docs/guide/occlusion.md)
};

// What a split is worth in a view. With Culling::subtree the priority of a split is its error in pixels; with
// Culling::star that error * (visible share of its faces)^visible_exponent
// * (cosine under which the eye sees them)^-grazing_exponent * (1 + unseen splits that it forces)^-forced_exponent.
// A change makes Refiner::update() refine from scratch.
struct PriorityOptions {
  Culling culling = Culling::star;  // which question decides
  double visible_exponent = 1.0;    // in [0, 8]
  double grazing_exponent = 0.5;    // in [0, 8]
  double forced_exponent = 0.5;     // in [0, 8]

  friend bool operator==(const PriorityOptions&, const PriorityOptions&) = default;
};

// When and how the current mesh is drawn as an occluder. A change makes Refiner::update() refine from scratch.
struct OccluderOptions {
  OccluderMode mode = OccluderMode::paper;  // what it hides
  // From scratch: draw it when so many splits are applied; ascending. Empty: at a third of the
  // budget in triangles and at sixths of that, as far as the mesh has moved by a pixel since the one before.
  std::vector<std::uint32_t> splits = {};
  // From scratch: whenever a new one is drawn, ask again about what an older one hid.
  bool retest_hidden = true;

  friend bool operator==(const OccluderOptions&, const OccluderOptions&) = default;
};

// What is asked about occlusion.
struct QueryOptions {
  Proxy proxy = Proxy::box;      // a change makes Refiner::update() refine from scratch
  std::uint32_t level_step = 2;  // ask about subtrees on every n-th forest level (2: odd levels, as in the paper); >= 1
  bool ask_stars = true;         // Culling::star: ask about each split's own faces before it is applied
  bool final_check = true;       // ask again about all that is hidden before the result; what turns out to be visible
                                 // replaces splits of lower priority

  friend bool operator==(const QueryOptions&, const QueryOptions&) = default;
};

// Refiner::update() only: how fast the mesh may follow the camera.
struct UpdateOptions {
  double hysteresis = 0.03;  // relative margin by which a candidate must exceed an applied split to replace it; [0, 1)
  std::size_t most_changes = 0;       // splits and merges in one call, except what the budget forces; 0: no limit
  double time_limit_ms = 0.0;         // no further splits and merges after so long; 0: no limit. Depends on a clock
  std::uint32_t geomorph_frames = 0;  // calls in which a new vertex slides from its parent to its place; 0: at once

  friend bool operator==(const UpdateOptions&, const UpdateOptions&) = default;
};

// All that can be set for one call.
struct RefineOptions {
  std::size_t budget = 10'000;  // triangles over all objects, never exceeded; at least Refiner::base_triangles()
  double tolerance_px = 0.0;  // stop when no visible split has a larger bound on its screen error; 0: spend the budget
  PriorityOptions priority = {};  // what a split is worth
  OccluderOptions occluder = {};  // when and how occluders are drawn
  QueryOptions queries = {};      // what is asked about occlusion
  UpdateOptions update = {};      // how fast Refiner::update() may go
  int threads = 1;  // that refinement from scratch may use, in [0, 1024]; 0: one for each core. More than 2 are not
                    // used. The result does not depend on it
  std::vector<ObjectEffects> effects = {};  // what works on each object, by object; empty: everything on all of them

  friend bool operator==(const RefineOptions&, const RefineOptions&) = default;
};

// Throws Error that names the first field that is not finite or out of its range, and the range. What depends on the
// objects, the budget and the number of effects, is not looked at. Refiner and AutoRefiner call it. O(occluder.splits).
void check_options(const RefineOptions& options);

}  // namespace occlod
