// The invariants of a hierarchy, checked without trusting anything in it. Tests call this after every build and load.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"

namespace occlod {

// Sizes and indices of the arrays fit together, so that a Hierarchy made from them can be walked safely: stars end
// where the next begins, ids are in range, dependencies and forest parents come first, every split is once in the
// forest. Returns what is wrong, or nothing. O(size).
[[nodiscard]] std::optional<std::string> check_structure(const HierarchyView& data);

// The same in parts: sizes, base mesh and roots; then splits [first, end), each on its own. What only a look at all of
// them shows is left to refinement, which descends to a child only if the child names its parent.
[[nodiscard]] std::optional<std::string> check_base(const HierarchyView& data);
[[nodiscard]] std::optional<std::string> check_splits(const HierarchyView& data, SplitId first, SplitId end);

struct ValidateOptions {
  int random_cuts = 16;  // random dependency-closed sets that are extracted and checked for conformity
};

// The four invariants of the design: (1) errors are saturated over dependencies and the forest; (2) sphere, box and
// cylinder contain all faces of the split and those below it; (3) so does the normal cone; (4) the splits replayed in
// order remove only active faces, end with the input triangles, and every random closed set is a conforming mesh: each
// of its edges that is no boundary of the input is shared. Returns one line per violation (at most 20), none when all
// hold.
[[nodiscard]] std::vector<std::string> validate(const Hierarchy& hierarchy, const ValidateOptions& options = {});

// True iff applying all splits gives exactly the triangles of `mesh`: the same positions in the same rotational order,
// as often.
[[nodiscard]] bool restores(const Hierarchy& hierarchy, const TriangleMesh& mesh);

}  // namespace occlod
