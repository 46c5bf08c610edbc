// Moves the vertices of a reduced mesh to where its triangles fit the input best.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/mesh.h"

namespace occlod {

// Refers to a mesh and to what was reduced from it by merging vertices into others. Everything must outlive the call.
struct Reduction {
  std::span<const glm::vec3> positions;  // of the input's vertices, object space
  std::span<const Triangle> faces;       // of the input
  std::span<const VertexId> target;      // per input vertex: the vertex of the input into which it was merged
  std::span<const Triangle> reduced;     // the faces that are left, of vertices of the input
  std::span<const glm::vec3> minima;     // per input vertex that is left: ReducedFaces::minima
  float scale;                           // ReducedFaces::scale
};

// Returns the new position of each vertex of the input that reduced faces use; others keep theirs. First each vertex
// goes to the minimum of the quadrics of all input faces that went into it (Garland & Heckbert 1997), then all vertices
// together to the least squares of the distances between the input's faces and the nearest reduced ones (as in Hoppe
// and others, Mesh Optimization, 1993, for one fixed assignment). Vertices that `held` names stay (one entry per vertex
// of the input, or empty), and so do those on borders of the reduced mesh and those whose faces would turn over. With
// `along_normals` vertices move along the mean normal of their faces only, so that what is mapped onto them does not
// slide. The same result for any number of threads. O(n).
[[nodiscard]] std::vector<glm::vec3> refit(const Reduction& reduction, std::span<const std::uint8_t> held,
                                           bool along_normals, unsigned threads);

}  // namespace occlod
