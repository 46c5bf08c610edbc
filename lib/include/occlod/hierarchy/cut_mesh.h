// Cuts that no view decides. Both kinds are closed under dependency, so their faces are a conforming mesh: splits
// depend on smaller numbers only, and errors are saturated.
#pragma once

#include <cstddef>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"

namespace occlod {

struct FixedCut {
  std::vector<bool> applied;  // one per split
  std::size_t splits = 0;     // how many of them are applied
  std::size_t triangles = 0;
  float guaranteed_error = 0.0F;  // bound on the distance between the cut and the input, object units; 0 = the input
  float error = 0.0F;             // largest quadric error of what is not applied, object units
};

// All splits applied: the input mesh. O(n).
[[nodiscard]] FixedCut full_cut(const Hierarchy& hierarchy);

// The first splits, those of the last and dearest collapses, as many as leave no more than `max_triangles`; the base
// mesh when even that has more. O(n).
[[nodiscard]] FixedCut cut_to_triangles(const Hierarchy& hierarchy, std::size_t max_triangles);

// The smallest cut whose guaranteed error is at most `max_error` (>= 0, object units): the splits that promise more are
// applied, no others. O(n).
[[nodiscard]] FixedCut cut_to_error(const Hierarchy& hierarchy, double max_error);

// The triangles of a cut, by the vertices of the hierarchy, in the order of its faces.
[[nodiscard]] std::vector<Triangle> triangles_of(const Hierarchy& hierarchy, const FixedCut& cut);

// The cut as a mesh of its own, with the hierarchy's attributes; vertices that no triangle uses are left out.
[[nodiscard]] TriangleMesh cut_mesh(const Hierarchy& hierarchy, const FixedCut& cut);

}  // namespace occlod
