// Which of the tests that cost time are made for one object, and what they achieved there.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <numeric>
#include <span>
#include <vector>

#include "occlod/base.h"
#include "occlod/hierarchy.h"
#include "occlod/mesh.h"
#include "occlod/view.h"
#include "occlod/visibility.h"

namespace occlod {

// Regions of an object are the cells of a grid over its box. A node is in the one that contains the centre of its
// sphere.
inline constexpr std::size_t effect_regions_per_axis = 4;
// Region i is cell (i % 4, i / 4 % 4, i / 16).
inline constexpr std::size_t effect_region_count =
    effect_regions_per_axis * effect_regions_per_axis * effect_regions_per_axis;
// One bit for each region.
inline constexpr std::uint64_t all_effect_regions = ~std::uint64_t{0};

// The tests that are made for one object.
struct ObjectEffects {
  bool cones = true;  // drop subtrees whose normal cone faces away; with Method::occlod this saves time and does not
                      // change which splits are worth a triangle
  bool occlusion = true;                       // ask whether parts of it are hidden; it hides others in any case
  std::uint64_t regions = all_effect_regions;  // occlusion: only in the regions whose bits are set

  // Counts the regions in which occlusion is asked about.
  [[nodiscard]] int regions_on() const noexcept { return occlusion ? std::popcount(regions) : 0; }
  friend bool operator==(const ObjectEffects&, const ObjectEffects&) = default;
};

// What the tests did for one object in one call.
struct ObjectEffectStats {
  std::size_t cone_tests = 0;   // nodes whose normal cone was tested
  std::size_t cone_culled = 0;  // of these, nodes that faced away
  // What queries did in one region.
  struct Region {
    std::uint32_t queries = 0;        // answered
    std::uint32_t hidden = 0;         // of these, answered hidden
    std::uint32_t hidden_stars = 0;   // of the hidden ones, queries about the star of one split
    float hidden_subtrees_px = 0.0F;  // sum over the other hidden ones of the node's error, each at most max_error_px.
                                      // Divided by RefineStats::level_px: about the splits below them that were saved
    static constexpr float max_error_px = 1e4F;  // pixels
  };
  std::array<Region, effect_region_count> regions{};  // by region

  // Counts the queries in all regions.
  [[nodiscard]] std::size_t queries() const noexcept {
    return std::accumulate(regions.begin(), regions.end(), std::size_t{0},
                           [](std::size_t sum, const Region& region) { return sum + region.queries; });
  }
  // Counts those of them that were answered hidden.
  [[nodiscard]] std::size_t hidden() const noexcept {
    return std::accumulate(regions.begin(), regions.end(), std::size_t{0},
                           [](std::size_t sum, const Region& region) { return sum + region.hidden; });
  }
};

// What a caller asks of refinement. Options belong to a call and not to a Refiner, so that a program may change any of
// them from frame to frame, as a slider does; Refiner::update() starts from scratch by itself where it has to.

// How a mesh is refined.
enum class Method {
  occlod,  // our own: what a split changes decides, and what is seen of it
  paper,   // as Birkholz & Rahn published it, to compare with
};

// What the current mesh hides.
enum class OccluderMode {
  paper,        // whatever is behind its triangles as they are: where they bulge out of the true surface, too much
  conservative  // only what stays hidden wherever collapses may have moved the surface: nothing that the input shows,
                // if both sides of its triangles hide. For any kind of error bound. What hides are squares of 8x8
                // pixels. Replays all collapses of a hierarchy the first time, and so reads all of a mapped file
                // (docs/guide/occlusion.md)
};

// What benchmarks and tests may turn besides: lib/refine/tuning.h, which is not installed.
struct Tuning;

// All that can be set for one call.
struct RefineOptions {
  std::size_t budget = 10'000;  // triangles over all objects, never exceeded; at least Refiner::base_triangles()
  double tolerance_px = 0.0;  // stop when no visible split has a larger bound on its screen error; 0: spend the budget
  Method method = Method::occlod;           // a change makes Refiner::update() refine from scratch
  OccluderMode mode = OccluderMode::paper;  // what occluders hide; a change makes Refiner::update() refine from scratch
  // Refiner::update() only: how fast the mesh may follow the camera.
  std::size_t max_changes = 0;        // splits and merges in one call, except what the budget forces; 0: no limit
  double time_limit_ms = 0.0;         // no further splits and merges after so long; 0: no limit. Depends on a clock
  std::uint32_t geomorph_frames = 0;  // calls in which a new vertex slides from its parent to its place; 0: at once
  int threads = 1;  // that may work on a call, in [0, 1024]; 0: one for each core. The result does not depend on it
  std::vector<ObjectEffects> effects = {};    // what works on each object, by object; empty: everything on all of them
  std::shared_ptr<const Tuning> tuning = {};  // for benchmarks and tests, in place of the method's own; null for users

  // Compares what is meant: a tuning equals one with the same values.
  friend bool operator==(const RefineOptions& a, const RefineOptions& b);
};

// Throws Error that names the first field that is not finite or out of its range, and the range. What depends on the
// objects, the budget and the number of effects, is not looked at. Refiner and AutoRefiner call it.
void check_options(const RefineOptions& options);

// What refinement gives back: the triangles of every object for one view, and numbers about how they came about.

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

// Draw `vertex` at mix(where its parent is drawn, its own position, t): see MorphedPositions.
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
  // Returns FNV-1a over the corners of all triangles of every object in order: equal iff they are, for all practical
  // purposes.
  [[nodiscard]] std::uint64_t hash() const noexcept;
};

// Vertices that slide from their parents to their own positions.

// The positions at which a mesh's vertices are drawn while some of them slide.
class MorphedPositions {
 public:
  // Copies `positions` (object space), which must also outlive this.
  explicit MorphedPositions(std::span<const glm::vec3> positions);

  // Takes the geomorphs of one call of Refiner::update() in place of those of the call before. O(n log n) for n of
  // both.
  void update(std::span<const Geomorph> geomorphs);

  // Returns the positions of all vertices, object space, after the last update().
  [[nodiscard]] std::span<const glm::vec3> positions() const noexcept { return drawn_; }
  // Returns the vertices that the last update() may have moved, ascending.
  [[nodiscard]] std::span<const VertexId> moved() const noexcept { return moved_; }

 private:
  std::span<const glm::vec3> own_;
  std::vector<glm::vec3> drawn_;
  std::vector<VertexId> under_way_;
  std::vector<VertexId> moved_;
};

// Triangles by their materials: what a program draws with one texture after the other.

// The triangles [first, first + count) of MaterialRanges::triangles have one material.
struct MaterialRange {
  MaterialId material = 0;  // an index into HierarchyView::materials
  std::uint32_t first = 0;  // index into MaterialRanges::triangles
  std::uint32_t count = 0;  // how many; at least 1
};

// What group_by_material() makes.
struct MaterialRanges {
  std::vector<Triangle> triangles;    // ids of wedges, by material, those of one in the order in which they came
  std::vector<MaterialRange> ranges;  // by ascending material, one for each that has triangles
};

// Sorts triangles of wedges, as RefinedObject has them, by counting. One range when the hierarchy has no materials.
// `out` is reused. O(triangles + materials).
void group_by_material(const Hierarchy& hierarchy, std::span<const Triangle> triangles, MaterialRanges& out);

// Refines one or more hierarchies for one view inside a hard triangle budget.

// One placed object. Several may share a hierarchy. The winding of its triangles in object space decides which side is
// its front, also under a mirroring transform.
struct RefineObject {
  const Hierarchy* hierarchy = nullptr;  // outlives the Refiner
  glm::dmat4 object_to_world{1.0};       // of its positions, see positions_to_world(); affine, invertible
  bool two_sided = false;                // back faces are visible too: no back-face culling
  bool attributes = true;  // how far texture coordinates, normals and colours slip counts as an error too: see
                           // Hierarchy::attribute_error()
};

// The age of a split about which nothing has been asked since refinement from scratch.
inline constexpr std::uint32_t never_asked = ~std::uint32_t{0};

// Chooses the triangles of all objects for a view. Reuses its memory from view to view; one thread at a time.
class Refiner {
 public:
  // Refines these objects. Throws Error when a hierarchy is missing.
  explicit Refiner(std::span<const RefineObject> objects);
  ~Refiner();
  Refiner(Refiner&&) noexcept;
  Refiner& operator=(Refiner&&) noexcept;

  // Counts the triangles of all base meshes: the smallest budget that can be kept.
  [[nodiscard]] std::size_t base_triangles() const noexcept;
  // Counts the triangles of all objects with all splits applied.
  [[nodiscard]] std::size_t full_triangles() const noexcept;

  // Places objects[object] elsewhere, from the next call on. To refine() this is as if the Refiner had been made so; to
  // update() as if the camera had moved, for this object and for what it hides of others. Throws Error when there is no
  // such object or the matrix is not finite, not affine or cannot be inverted; then it stays where it is.
  void set_transform(std::size_t object, const glm::dmat4& object_to_world);

  // Refines from the base meshes. Throws Error for options that check_options() refuses, a budget smaller than
  // base_triangles(), effects that are neither none nor one for each object, or a hierarchy that turns out to be
  // damaged. The result is valid until the next call. Deterministic for a backend whose answers are.
  const Refinement& refine(const View& view, const RefineOptions& options, Visibility& visibility);

  // Goes on from the cut of the call before: merges splits that have lost priority, applies those that have gained.
  // Refines from the base meshes when there is no such cut, when options.method or options.mode has
  // changed, or when a quarter of the cut has lost its worth at once (a jump of the camera; not with limits). Draws an
  // occluder in each frame. The same budget, errors thrown and validity as refine(), nearly the same screen errors;
  // deterministic for the same sequence of calls, unless time_limit_ms is set.
  const Refinement& update(const View& view, const RefineOptions& options, Visibility& visibility);

  // Gives the last result away with its memory, so that what points into its arrays stays valid beyond the next call;
  // update() goes on from a copy. O(size of the result).
  [[nodiscard]] Refinement take_result();

  // For each of objects[object].splits of the last call, in their order: how many occluders have been drawn since an
  // answer last said that it, or an applied split below it in the forest, is visible; never_asked where no answer has.
  // After refinement from scratch 0. O(splits log splits).
  [[nodiscard]] std::vector<std::uint32_t> visibility_ages(std::size_t object) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace occlod
