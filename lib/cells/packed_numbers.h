// An order of ids in which those of each cell are few runs: a sort instead of the tour of vLOD (2003).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cells/packed_geometry.h"
#include "mesh/section_file.h"
#include "occlod/vlod_file.h"

namespace occlod {

// Of each id its place. `added`: of each node of a tree of cells, in depth-first order, what all cells below it have
// and no node above adds, each id once; ids < count.
//
// Sorted by the list of nodes that add an id, a list that goes on before one that ends; then by id. So ids that are in
// the same cells are one run. And an id that is in every cell that another is in comes before it, or has the smaller
// number and the same list: where both lists differ first, its node is farther up, or earlier, or the other's list has
// ended. A split that another depends on is such an id, so files of splits may be renumbered like this. O(n log n) in
// what all nodes add, typically.
[[nodiscard]] std::vector<std::uint32_t> places_by_nodes(std::span<const std::vector<std::uint32_t>> added,
                                                         std::uint32_t count);

}  // namespace occlod

namespace occlod::vlod {

// The numbers that splits have in a packed .vlod file, and in their hierarchies.

// Section PERM of the numbers in their hierarchies of the splits of a mesh, in the order of the file: each less the one
// before and 1, modulo 2^32.
[[nodiscard]] std::vector<std::uint32_t> differences_of(std::span<const SplitId> numbers);

class PackedNumbers {
 public:
  // Throws Error when a split is out of range or there twice.
  PackedNumbers(sections::SectionReader& reader, const PackedGeometry& geometry, std::span<const VlodObject> objects);

  // From the file's to those of the hierarchy, and sorted by them. All splits are within the mesh.
  void restore(std::uint32_t mesh, ObjectAdditions& additions) const;

 private:
  [[nodiscard]] bool take(std::span<const std::uint32_t> differences, std::uint32_t end);

  std::vector<std::vector<SplitId>> numbers_;  // by mesh
};

}  // namespace occlod::vlod
