// How far the input is from any cut: one half of the guaranteed error.
#pragma once

#include <span>
#include <vector>

#include "splits/level_faces.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// Every cell of the input (surface_samples.h) is, in every cut, the charge of exactly one face: it starts with one that
// holds its sample, and when a collapse ends that face the nearest of those that the collapse makes takes over.
struct ForwardErrors {
  std::vector<float> errors;  // for each collapse a bound on the distance of every cell that faces made by it are
                              // charged with from the face; at least `floor`
  float floor = 0.0F;         // more than cells are away from the faces of the input that they start with
};
[[nodiscard]] ForwardErrors forward_errors(const TriangleMesh& mesh, const LevelFaces& levels);

}  // namespace occlod
