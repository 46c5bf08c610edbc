// The invariants of a hierarchy, checked without trusting anything in it. Tests call this after every build and load.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"

namespace occlod {

// Checks that sizes and indices of the arrays fit together, so that a Hierarchy made from them can be traversed safely:
// each star ends where the next begins, ids are in range, dependencies and forest parents come first, every split is in
// the forest once. Returns what is wrong, or nothing. O(size).
[[nodiscard]] std::optional<std::string> check_structure(const HierarchyView& data);

// How thoroughly validate() looks.
struct ValidateOptions {
  int random_cuts = 16;  // random dependency-closed sets that are extracted and checked for conformity
};

// Checks four invariants: (1) no error is smaller than that of a split that depends on it or is below it in the forest;
// (2) sphere, box and cylinder contain all faces of the split and those below it; (3) the normal cone contains their
// normals; (4) applying the splits in order removes only active faces and ends with the input triangles, and every
// random closed set gives a conforming mesh, in which each edge that is no boundary of the input is shared. Returns one
// line per violation (at most 20), none when all hold. Throws Error when a mapped file is damaged. O(size *
// random_cuts).
[[nodiscard]] std::vector<std::string> validate(const Hierarchy& hierarchy, const ValidateOptions& options = {});

// True iff applying all splits gives exactly the triangles of `mesh`: the same positions in the same rotational order,
// each as often, with the same materials, and at each corner the same normal, colour and texture coordinate, bit for
// bit, of those that the mesh has. O(n log n).
[[nodiscard]] bool restores(const Hierarchy& hierarchy, const TriangleMesh& mesh);

}  // namespace occlod
