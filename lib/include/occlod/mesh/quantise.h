// Positions on a lattice, so that they take fewer bytes in files.
#pragma once

#include "occlod/math/bounds.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// The least power of two of which the box's longest side is at most 2^bits; no finer than floats are at its farthest
// corner. 0 for a box without extent. `bits` in [1, 30]. O(1).
[[nodiscard]] float lattice_step(const Box& box, int bits);

// The multiple of `step` next to each coordinate; of two as near, the even one. `step`: of lattice_step() for a box
// that contains p; 0 leaves p as it is. So the same wherever p occurs. No coordinate moves by more than half a step.
[[nodiscard]] glm::vec3 round_to_lattice(const glm::vec3& p, float step);

// All positions of a mesh: what lies between them may fall together, so clean() it before it is used. O(vertices).
void round_to_lattice(TriangleMesh& mesh, float step);

}  // namespace occlod
