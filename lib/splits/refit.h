// Moves the vertices of a reduced mesh to where its triangles fit the input best.
#pragma once

#include <cstddef>
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

// Limits where vertices may go.
struct RefitRules {
  std::span<const std::uint8_t> held{};  // per vertex of the input, nonzero: stays where it is; empty: none
  // Vertices move along the mean normal of their faces only, so that what is mapped onto them does not slide.
  bool along_normals = false;
  float lattice_step = 0.0F;      // object space: new positions are multiples of it; 0: any
  float least_step = 0.0F;        // object space: vertices that would move by less stay
  std::span<const float> most{};  // per vertex of the input, object space: it moves no farther; empty: any
  bool keeps_apart = false;       // no vertex goes to where another one of the input is
};

// Returns the new position of each vertex of the input that reduced faces use; others keep theirs. First each vertex
// goes to the minimum of the quadrics of all input faces that went into it (Garland & Heckbert 1997), then all vertices
// together to the least squares of the distances between the input's faces and the nearest reduced ones (as in Hoppe
// and others, Mesh Optimization, 1993, for one fixed assignment). Vertices on borders of the reduced mesh stay, and
// those whose faces would turn over. The same result for any number of threads. O(n).
[[nodiscard]] std::vector<glm::vec3> refit(const Reduction& reduction, const RefitRules& rules, unsigned threads);

// Marks the vertices whose corners have several wedges: creases and edges of colours. O(n).
[[nodiscard]] std::vector<std::uint8_t> on_seams(std::span<const Triangle> faces, std::span<const Triangle> wedges,
                                                 std::size_t vertex_count);

}  // namespace occlod
