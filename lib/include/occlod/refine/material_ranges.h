// Triangles by their materials: what a program draws with one texture after the other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

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

}  // namespace occlod
