// Cuts that do not depend on a view. All are closed under dependency, because splits depend on smaller ids only and
// errors are saturated; so their faces form a conforming mesh.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"

namespace occlod {

// Which splits are applied, and what that gives.
struct FixedCut {
  std::vector<bool> applied;      // one per split
  std::size_t splits = 0;         // how many of them are applied
  std::size_t triangles = 0;      // of the cut
  float guaranteed_error = 0.0F;  // bound on the distance between the cut and the input, object units; 0 = the input
  float error = 0.0F;             // largest quadric error of a split that is not applied, object units
};

// All splits applied: the input mesh. O(n). Like all functions here it throws Error when a mapped file is damaged.
[[nodiscard]] FixedCut full_cut(const Hierarchy& hierarchy);

// As many of the first splits, which undo the last and costliest collapses, as give no more than `max_triangles`; the
// base mesh when even that has more. O(n).
[[nodiscard]] FixedCut cut_to_triangles(const Hierarchy& hierarchy, std::size_t max_triangles);

// The smallest cut whose guaranteed error is at most `max_error` (>= 0, object units): exactly the splits with a larger
// bound are applied. O(n).
[[nodiscard]] FixedCut cut_to_error(const Hierarchy& hierarchy, double max_error);

// The triangles of a cut, as ids of the hierarchy's vertices: base faces first, then by split and slot. O(n).
[[nodiscard]] std::vector<Triangle> triangles_of(const Hierarchy& hierarchy, const FixedCut& cut);

// The same triangles as ids of wedges: what to draw. The same where no vertex has more than one. O(n).
[[nodiscard]] std::vector<Triangle> wedge_triangles_of(const Hierarchy& hierarchy, const FixedCut& cut);

// The wedges at the corners of a face with these vertices, in the same order.
[[nodiscard]] inline Triangle wedges_of_face(const Hierarchy& hierarchy, const FaceRef& face,
                                             const Triangle& vertices) {
  if (!hierarchy.has_seams()) return vertices;
  return face.split == no_id ? hierarchy.data().base_corners[face.slot]
                             : hierarchy.corners(face.split).inserted(face.slot);
}

// Triangles of wedges, as RefinedObject has them, as a mesh of their own, with the hierarchy's attributes and without
// vertices and wedges that no triangle uses. Vertices are numbered as triangles first use them. O(n).
[[nodiscard]] TriangleMesh mesh_of(const Hierarchy& hierarchy, std::span<const Triangle> wedge_triangles);

// The same of a cut. O(n).
[[nodiscard]] TriangleMesh cut_mesh(const Hierarchy& hierarchy, const FixedCut& cut);

}  // namespace occlod
