// Closes small borders.
#pragma once

#include <cstddef>
#include <functional>

#include "repair/halfedge_mesh.h"
#include "repair/repair.h"

namespace occlod::repair {

// Closes borders of at most `max_edges` with triangles between their vertices, except a border around a single triangle
// and those for which CGAL finds no surface. Counts holes_filled, triangles_added and borders_left. `progress` is
// called with the share done.
void fill_holes(HalfedgeMesh& mesh, std::size_t max_edges, const std::function<void(double)>& progress,
                RepairCounts& counts);

}  // namespace occlod::repair
