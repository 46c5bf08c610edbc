// Small meshes by property. Closed ones are wound counter-clockwise seen from outside; none has unreferenced vertices.
#pragma once

#include <cstdint>

#include "occlod/mesh.h"

namespace occlod::test {

// With boundary.
[[nodiscard]] TriangleMesh single_triangle();
[[nodiscard]] TriangleMesh grid(int nx, int ny);  // nx x ny cells on the unit square, facing +z; 2 nx ny triangles
[[nodiscard]] TriangleMesh fan(int n);            // n >= 3 triangles round vertex 0, which is inside: valence n
[[nodiscard]] TriangleMesh moebius(int n);        // n >= 3 cells; 2 n triangles; one inconsistent edge, at the seam

// Closed.
[[nodiscard]] TriangleMesh tetrahedron();
[[nodiscard]] TriangleMesh octahedron_sphere(int level);                 // 4^(level+1) + 2 vertices, unit radius
[[nodiscard]] TriangleMesh noisy_sphere(int level, std::uint64_t seed);  // the same, displaced along the radius
[[nodiscard]] TriangleMesh torus(int nu, int nv);                        // genus 1; nu, nv >= 3; 2 nu nv triangles

// The unit square in z = 0, once facing up and once down, cut along the same diagonal: 4 vertices, 4 triangles, two on
// each side of each pair of corners; the diagonal is used by four.
[[nodiscard]] TriangleMesh double_sided_quad();

// Non-manifold.
[[nodiscard]] TriangleMesh bow_tie();        // two triangles that share only vertex 0
[[nodiscard]] TriangleMesh book(int pages);  // `pages` triangles that share the edge 0-1

// Several components.
[[nodiscard]] TriangleMesh two_components();        // a tetrahedron and an octahedron, apart
[[nodiscard]] TriangleMesh many_tetrahedra(int n);  // n copies in a row

// Returns the area of all triangles.
[[nodiscard]] double area_of(const TriangleMesh& mesh);

// Appends `part`, moved by `offset`, as vertices of its own.
void append(TriangleMesh& mesh, const TriangleMesh& part, const glm::vec3& offset);

}  // namespace occlod::test
