// Orders ids so that those of each cell form few runs: a sort instead of the tour of vLOD (2003).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cells/packed_geometry.h"
#include "mesh/section_file.h"
#include "occlod/vlod_file.h"

namespace occlod {

// Returns the place of each id. `added` holds, for each node of a tree of cells in depth-first order, the ids that all
// cells below it have and no node above adds, each id once; ids < count.
//
// Ids are sorted by the list of nodes that add them, where a list that continues comes before one that ends; then by
// id. So ids that are in the same cells form one run. And an id that is in every cell that another is in comes before
// it, or has the smaller number and the same list: where both lists first differ, its node is farther up, or earlier,
// or the other's list has ended. A split on which another depends is such an id, so splits of files may be renumbered
// like this. Typically O(n log n) in the size of what all nodes add.
[[nodiscard]] std::vector<std::uint32_t> places_by_nodes(std::span<const std::vector<std::uint32_t>> added,
                                                         std::uint32_t count);

}  // namespace occlod

namespace occlod::vlod {

// Maps the numbers that splits have in a packed .vlod file to those in their hierarchies.

// Encodes section PERM: the hierarchy's numbers of the splits of a mesh, in the order of the file, each minus the one
// before and minus 1, modulo 2^32.
[[nodiscard]] std::vector<std::uint32_t> differences_of(std::span<const SplitId> numbers);

class PackedNumbers {
 public:
  // Throws Error when a split is out of range or appears twice.
  PackedNumbers(sections::SectionReader& reader, const PackedGeometry& geometry, std::span<const StoredObject> objects);

  // Converts the file's numbers to those of the hierarchy and sorts by them. All splits must be within the mesh.
  void restore(std::uint32_t mesh, ObjectAdditions& additions) const;

 private:
  [[nodiscard]] bool take(std::span<const std::uint32_t> differences, std::uint32_t end);

  std::vector<std::vector<SplitId>> numbers_;  // per mesh
};

}  // namespace occlod::vlod
