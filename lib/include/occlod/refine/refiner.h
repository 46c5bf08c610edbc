// Refines one or more hierarchies for one view inside a hard triangle budget.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/refine/object_effects.h"
#include "occlod/refine/visibility.h"
#include "occlod/view/view.h"

namespace occlod {

// One placed object. Several may share a hierarchy. Its front is where the winding of its triangles says in object
// space, also under a mirroring transform.
struct RefineObject {
  const Hierarchy* hierarchy = nullptr;  // outlives the Refiner
  glm::dmat4 object_to_world{1.0};       // affine, invertible
  bool two_sided = false;                // back faces are seen: no back-face culling
};

enum class Culling {
  subtree,  // the paper's one question: a split is applied when the bounds of its subtree may be seen
  star,     // the design's two: descend by the subtree's bounds, apply by the faces that the split itself changes
};

enum class Proxy { sphere, box, cylinder };

// What the current mesh hides.
enum class OccluderMode {
  paper,        // whatever is behind its triangles as they are: where they bulge out of the true surface, too much
  conservative  // only faces moved back by the bound on their distance from the input: what they hide, the input hides.
                // Of solids, seen from outside and thicker than the bounds, front faces; of two-sided objects, faces
                // farther from every border than that may have moved
};

struct RefineOptions {
  std::size_t budget = 10'000;  // triangles over all objects; never exceeded
  double tolerance_px = 0.0;  // stop when no visible split has a larger guaranteed screen error; 0 = use the budget up
  Culling culling = Culling::star;
  // star: a split's priority is its error in pixels * (visible share of its faces)^visible_exponent
  // * (cosine under which the eye sees them)^-grazing_exponent * (1 + unseen splits that it forces)^-forced_exponent.
  double visible_exponent = 1.0;
  double grazing_exponent = 0.5;
  double forced_exponent = 0.5;
  // Draw the occluder when so many splits are applied; ascending. Empty: whenever the mesh has changed enough.
  std::vector<std::uint32_t> occluder_splits = {};
  bool retest_hidden = true;  // ask again about what an older occluder hid whenever a new one is drawn
  bool final_check = true;    // and before the final mesh; what that shows takes the place of what matters less
  OccluderMode occluder_mode = OccluderMode::paper;
  Proxy proxy = Proxy::box;  // the bounds of a subtree that are asked about
  std::uint32_t level_step =
      2;                  // ask about subtrees on every n-th forest level only (2 = odd levels, as in the paper); >= 1
  bool ask_stars = true;  // star: ask about each split's own star before it is applied
  std::vector<ObjectEffects> effects = {};  // what works on each object; empty = everything on all of them

  // Refiner::update() only.
  double hysteresis = 0.03;      // a split that is applied gives way only to what matters more by this part; in [0, 1)
  std::size_t most_changes = 0;  // splits and merges in one call, but for what the budget forces; 0 = no limit
  double time_limit_ms = 0.0;    // no further splits and merges after so long; 0 = no limit. Depends on a clock
  std::uint32_t geomorph_frames = 0;  // vertices that appear slide from their parents for so many calls

  friend bool operator==(const RefineOptions&, const RefineOptions&) = default;
};

struct RefineStats {
  std::size_t budget = 0;
  std::size_t triangles = 0;
  std::size_t splits = 0;                // applied
  std::size_t forced_splits = 0;         // of those, applied only because another depends on them
  std::size_t forced_unseen_splits = 0;  // star: and change nothing that is seen: what conformity costs
  std::size_t rejected_splits = 0;       // visible, but would have broken the budget
  std::size_t visits = 0;                // nodes looked at
  std::size_t culled_frustum = 0;        // nodes and stars outside the frustum
  std::size_t culled_backface = 0;       // and facing away
  std::size_t culled_occlusion = 0;      // and hidden at the end
  std::size_t queries = 0;               // asked of the backend
  std::size_t queries_hidden = 0;        // answered "hidden"
  std::size_t occluder_draws = 0;
  std::size_t readmitted = 0;  // hidden by an earlier occluder and not by the final mesh
  std::size_t taken_back = 0;  // splits that made room for these
  double max_error_px = 0.0;   // largest guaranteed screen error left on surface held to be visible; infinite when the
                               // eye is inside the bounds of a split that is not applied
  double max_quadric_error_px =
      0.0;                     // the same of the quadric error: about the root mean square distance instead of a bound
  double level_px = 0.0;       // priority of what would have been next when the budget was used up; 0 = nothing
  std::size_t new_splits = 0;  // applied in this call
  std::size_t merged_splits = 0;      // taken back in this call, applied in an earlier one
  std::size_t changed_triangles = 0;  // places of the index buffers that differ from those of the call before
  bool pending = false;               // update(): a limit ended the call before its work was done
  double refine_ms = 0.0;             // wall time without occlusion_ms
  double occlusion_ms = 0.0;          // drawing occluders, asking and waiting for answers
};

struct TriangleRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

// Draw `vertex` at mix(where its parent is drawn, its own position, t): see geomorph.h.
struct Geomorph {
  VertexId vertex = no_id;
  VertexId parent = no_id;
  float t = 1.0F;
};

// The active triangles of one object: ids into the hierarchy's vertices. From refine(): base faces first, then by split
// and slot. From update(): those that stay active keep their places, but for those that fill holes.
struct RefinedObject {
  std::vector<Triangle> triangles;
  std::vector<SplitId> splits;         // applied, ascending: the whole state
  std::vector<TriangleRange> changes;  // of `triangles` since the call before, ascending; the size may change too
  std::vector<Geomorph> geomorphs;     // under way, parents before their children
};

struct Refinement {
  std::vector<RefinedObject> objects;  // as given to the Refiner
  RefineStats stats;
  std::vector<ObjectEffectStats> effects;  // by object
  // FNV-1a over the corners of all triangles of every object in order: equal iff they are, for all practical purposes.
  [[nodiscard]] std::uint64_t hash() const noexcept;
};

// The age of what no answer has been about since refinement from scratch.
inline constexpr std::uint32_t never_asked = ~std::uint32_t{0};

// Reuses its memory from view to view; one thread at a time.
class Refiner {
 public:
  // Throws Error when a hierarchy is missing.
  explicit Refiner(std::span<const RefineObject> objects);
  ~Refiner();
  Refiner(Refiner&&) noexcept;
  Refiner& operator=(Refiner&&) noexcept;

  // Triangles of all base meshes: the smallest budget that can be kept.
  [[nodiscard]] std::size_t base_triangles() const noexcept;
  [[nodiscard]] std::size_t full_triangles() const noexcept;

  // Refines from the base meshes. Throws Error when the budget is smaller than base_triangles(). The result is valid
  // until the next call. Deterministic for a backend whose answers are.
  const Refinement& refine(const View& view, const RefineOptions& options, Visibility& visibility);

  // Goes on from the cut of the call before, merging what has lost importance and splitting what has gained. Refines
  // from the base meshes when there is none, when more of the options than budget, tolerance, limits and what is asked
  // (level_step, ask_stars, final_check, effects) has changed, or when a quarter of the cut has become worth little at
  // once (a jump of the camera; not with limits). Draws an occluder in each frame: occluder_splits and retest_hidden
  // are for refinement from scratch. The same budget and validity as refine(), nearly the same errors; deterministic
  // for the same sequence of calls, unless time_limit_ms is set.
  const Refinement& update(const View& view, const RefineOptions& options, Visibility& visibility);

  // Of objects[object].splits of the last call, in their order: how many occluders before the last one an answer said
  // that it, or an applied split that descends from it in the forest, is visible; never_asked, or after refinement from
  // scratch 0. O(splits log splits).
  [[nodiscard]] std::vector<std::uint32_t> visibility_ages(std::size_t object) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace occlod
