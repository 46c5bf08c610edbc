// Guaranteed errors that are measured instead of added up. docs/guide/error_metric.md has the proofs.
#pragma once

#include "occlod/mesh/triangle_mesh.h"
#include "splits/simplify.h"

namespace occlod {

// Sets guaranteed_error of all collapses of `sequence`, which simplify() made of `mesh`, so that no cut is farther from
// the input, both ways, than the largest of the collapses that it has made: measured against the input where errors are
// larger than its triangles; below that they stay added up, as simplify() left them. The mesh is scaled for the time of
// the call. O(n log n).
void measure_errors(TriangleMesh& mesh, CollapseSequence& sequence);

}  // namespace occlod
