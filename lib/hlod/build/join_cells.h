// Joins small neighbouring cells of an octree to groups of nearly the wanted size.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hlod/build/cells.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod::hlod {

// The group of each leaf cell. Groups are numbered along the Morton curve of their first cells.
struct CellGroups {
  std::vector<std::uint32_t> group_of;
  std::uint32_t count = 0;
};

// Within each inner cell, from the finest to the root, joins the two groups that share most vertices for their size as
// long as both together have at most `most_triangles`; what has less than half as many is handed up to the next cell.
// Cells hold triangles, by id. The result does not depend on the threads. O(n + cells log cells).
[[nodiscard]] CellGroups join_cells(const Cells& cells, std::span<const Triangle> triangles, std::size_t vertex_count,
                                    std::uint32_t most_triangles, unsigned threads);

// Every leaf cell is a group.
[[nodiscard]] CellGroups separate_cells(const Cells& cells);

}  // namespace occlod::hlod
