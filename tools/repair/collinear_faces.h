// Removes triangles whose corners lie on one line.
#pragma once

#include "repair/halfedge_mesh.h"
#include "repair/repair.h"

namespace occlod::repair {

// Removes them without changing the surface as a set of points: the vertex in the middle of the longest side becomes a
// corner of the triangle beyond, which is cut in two there; where nothing is beyond, the triangle is dropped. CGAL's
// remove_degenerate_faces() is not used, because it moves vertices along the line, makes new ones, and may cut off a
// corner of three triangles. The test whether corners lie on one line is exact. Counts zero_area_dropped, _flipped and
// _kept.
void remove_collinear_faces(HalfedgeMesh& mesh, RepairCounts& counts);

}  // namespace occlod::repair
