// What refinement gives back: the triangles of every object for one view, and numbers about how they came about.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "occlod/core/ids.h"
#include "occlod/mesh/triangle_mesh.h"
#include "occlod/refine/object_effects.h"

namespace occlod {

// Counts, errors and times. Every field is set by each call of refine() and update(), whichever way it took.
struct RefineStats {
  // Of the mesh as it stands after the call.
  std::size_t budget = 0;           // as given
  std::size_t triangles = 0;        // of all objects
  std::size_t splits = 0;           // applied
  std::size_t nodes = 0;            // of the forests, that refinement reached: roots, and children of what it descended
  std::size_t culled_frustum = 0;   // of these nodes, outside the frustum
  std::size_t culled_backface = 0;  // of the others, facing away; or (star) no face of their own split is seen
  std::size_t culled_occlusion = 0;  // of the others, hidden by the occluder that they were last asked about against
  double max_error_px = 0.0;  // largest guaranteed screen error left on surface held to be visible, or slip of its
                              // attributes; infinite when the eye is inside the bounds of a split that is not applied
  double max_quadric_error_px = 0.0;  // the same of the quadric error and attributes together: about the root mean
                                      // square distance, no bound
  double level_px = 0.0;              // priority of what would have been next when the budget was used up; 0 = nothing
  bool pending = false;               // update(): a limit ended the call before its work was done

  // Of this call. Refinement from the base meshes, also by update(), applies all splits anew and changes all triangles.
  std::size_t new_splits = 0;            // applied by this call and not there before
  std::size_t forced_splits = 0;         // of those, applied only because another depends on them
  std::size_t forced_unseen_splits = 0;  // of those, star: change nothing that is seen: what conformity costs
  std::size_t merged_splits = 0;         // update(): there before, and taken back by this call
  std::size_t rejected_splits = 0;       // visible, but would have broken the budget
  std::size_t readmitted = 0;  // hidden by an earlier occluder, asked about again and visible: by the final check, or
                               // when a frame begins
  std::size_t taken_back = 0;  // splits given up, also such as have come back: to make room, or needless
  std::size_t visits = 0;      // from scratch nodes reached; going on candidates tried
  std::size_t queries = 0;     // asked of the backend
  std::size_t queries_hidden = 0;     // of those, answered "hidden"
  std::size_t occluder_draws = 0;     // occluders drawn
  std::size_t changed_triangles = 0;  // places of the index buffers that differ from those of the call before
  double refine_ms = 0.0;             // wall time without occlusion_ms
  double occlusion_ms = 0.0;          // drawing occluders, asking and waiting for answers
};

// The triangles [first, first + count).
struct TriangleRange {
  std::uint32_t first = 0;  // index into RefinedObject::triangles
  std::uint32_t count = 0;  // how many
};

// Draw `vertex` at mix(where its parent is drawn, its own position, t): see geomorph.h.
struct Geomorph {
  WedgeId vertex = no_id;  // that slides; of a vertex with several wedges each has an entry
  WedgeId parent = no_id;  // from which it slides, a wedge of the parent vertex; itself under way or not
  float t = 1.0F;          // 0 at the parent, 1 at its own place
};

// The active triangles of one object: ids into the hierarchy's wedges, which are its vertices where it has no seams.
// From refine(): base faces first, then by split and slot. From update(): those that stay active keep their places, but
// for those that fill holes.
struct RefinedObject {
  std::vector<Triangle> triangles;     // ids of the hierarchy's wedges: see Hierarchy::vertex_of_wedge()
  std::vector<SplitId> splits;         // applied, ascending: the whole state
  std::vector<TriangleRange> changes;  // of `triangles` since the call before, ascending; the size may change too
  std::vector<Geomorph> geomorphs;     // under way, parents before their children
};

// What one call gives; valid until the next call of the same Refiner.
struct Refinement {
  std::vector<RefinedObject> objects;      // as given to the Refiner
  RefineStats stats;                       // of the call
  std::vector<ObjectEffectStats> effects;  // by object
  // FNV-1a over the corners of all triangles of every object in order: equal iff they are, for all practical purposes.
  [[nodiscard]] std::uint64_t hash() const noexcept;
};

}  // namespace occlod
