// Reduces a mesh to fewer triangles, the same for every view, without a hierarchy.
#pragma once

#include <cstddef>
#include <functional>

#include "occlod/mesh.h"

namespace occlod {

// Options of simplify().
struct SimplifyOptions {
  double boundary_weight = 1.0;   // as BuildOptions::boundary_weight
  double attribute_weight = 0.7;  // as BuildOptions::attribute_weight
  // Whether vertices move from the positions of the input to where the surface fits best: about two thirds of the
  // distance at the same number of triangles. Borders stay, and without texture coordinates seams too; with them all
  // vertices move along their normals only.
  bool refit = true;
  int threads = 0;                            // in [0, 1024]; 0: one per core. The result does not depend on it
  std::function<bool(double)> progress = {};  // as BuildOptions::progress; ends at 1
};

// Returns the mesh with at most `max_triangles` triangles (>= 1), reduced by half-edge collapses in the order of their
// quadric error, as build_hierarchy() makes them; the mesh itself when it has no more. Attributes, materials and
// textures are kept. Throws Error as build_hierarchy() does, and when nothing would be left, with the fewest triangles
// that are possible: closed surfaces have at least 4. Small parts vanish first. O(n log n) time; needs about 270 bytes
// a vertex.
[[nodiscard]] TriangleMesh simplify(const TriangleMesh& mesh, std::size_t max_triangles,
                                    const SimplifyOptions& options = {});

// Holds a reduced mesh and its distance from the input.
struct SimplifiedMesh {
  TriangleMesh mesh;      // as simplify() leaves it
  double distance = 0.0;  // object units: of the vertex of either surface that is farthest from the other
};

// Returns a mesh with about as few triangles as possible whose every point lies within `max_distance` (object units,
// > 0) of the input, and the input's within it of the mesh: bisects the number of triangles to 5 %, and keeps vertices
// of the input at places that would be too far. Attributes do not count. Throws as simplify() does. Measuring takes
// up to some hundred times as long as simplify().
[[nodiscard]] SimplifiedMesh simplify_within(const TriangleMesh& mesh, double max_distance,
                                             const SimplifyOptions& options = {});

}  // namespace occlod
