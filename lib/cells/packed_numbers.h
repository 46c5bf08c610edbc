// The numbers that splits have in a packed .vlod file, and in their hierarchies.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/section_file.h"
#include "occlod/viewcells/vlod_file.h"
#include "cells/packed_geometry.h"

namespace occlod::vlod {

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
