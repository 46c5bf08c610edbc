// Refines one or more hierarchies for one view inside a hard triangle budget.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/refine/refine_options.h"
#include "occlod/refine/refinement.h"
#include "occlod/refine/visibility.h"
#include "occlod/view/view.h"

namespace occlod {

// One placed object. Several may share a hierarchy. The winding of its triangles in object space decides which side is
// its front, also under a mirroring transform.
struct RefineObject {
  const Hierarchy* hierarchy = nullptr;  // outlives the Refiner
  glm::dmat4 object_to_world{1.0};       // affine, invertible
  bool two_sided = false;                // back faces are visible too: no back-face culling
  bool attributes = true;  // how far texture coordinates, normals and colours slip counts as an error too: see
                           // Hierarchy::attribute_error()
};

// The age of a split about which nothing has been asked since refinement from scratch.
inline constexpr std::uint32_t never_asked = ~std::uint32_t{0};

// Chooses the triangles of all objects for a view. Reuses its memory from view to view; one thread at a time.
class Refiner {
 public:
  // Throws Error when a hierarchy is missing.
  explicit Refiner(std::span<const RefineObject> objects);
  ~Refiner();
  Refiner(Refiner&&) noexcept;
  Refiner& operator=(Refiner&&) noexcept;

  // Triangles of all base meshes: the smallest budget that can be kept.
  [[nodiscard]] std::size_t base_triangles() const noexcept;
  // Triangles of all objects with all splits applied.
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
  // Refines from the base meshes when there is no such cut, when options.priority, options.occluder or the proxies have
  // changed, or when a quarter of the cut has lost its worth at once (a jump of the camera; not with limits). Draws an
  // occluder in each frame: occluder.splits and occluder.retest_hidden concern refinement from scratch only. The same
  // budget, errors thrown and validity as refine(), nearly the same screen errors; deterministic for the same sequence
  // of calls, unless update.time_limit_ms is set.
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
