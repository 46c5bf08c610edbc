#include "splits/measure_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "splits/backward_error.h"
#include "splits/forward_error.h"
#include "splits/level_faces.h"
#include "splits/unit_scale.h"

namespace occlod {
namespace {

// No error is smaller than those of the collapses on which it stands.
std::vector<float> saturated(const LevelFaces& levels, std::vector<float> errors) {
  for (CollapseIndex c = 0; c < levels.collapse_count(); ++c)
    for (FaceId f = levels.first_ended(c); f < levels.first_ended(c + 1); ++f)
      if (const CollapseIndex maker = levels.maker(f); maker != no_id) errors[c] = std::max(errors[c], errors[maker]);
  return errors;
}

// What points made in single precision may be off, wherever the mesh is.
float position_rounding(const TriangleMesh& mesh) {
  float largest = 0.0F;
  for (const glm::vec3& p : mesh.positions) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return 16.0F * std::numeric_limits<float>::epsilon() * largest;
}

// Of a mesh and a sequence in units in which squares stay in range.
void measure_scaled(const TriangleMesh& mesh, CollapseSequence& sequence) {
  const LevelFaces levels(sequence);
  const ForwardErrors forward = forward_errors(mesh, levels);
  const std::vector<float> backward = backward_errors(mesh, levels, saturated(levels, forward.errors));
  const float rounding = position_rounding(mesh);
  for (CollapseIndex c = 0; c < levels.collapse_count(); ++c) {
    float& error = sequence.collapses[c]->guaranteed_error;
    const bool is_fine = error <= forward.floor && forward.errors[c] <= forward.floor;
    if (!is_fine) error = std::max(forward.errors[c], backward[c]) + rounding;
  }
}

}  // namespace

void measure_errors(TriangleMesh& mesh, CollapseSequence& sequence) {
  const float scale = power_of_two_scale(mesh.positions);
  std::vector<glm::vec3> positions = mesh.positions;
  for (glm::vec3& p : mesh.positions) p *= scale;
  for (Collapse* collapse : sequence.collapses) {
    collapse->guaranteed_error = scaled_up(collapse->guaranteed_error, scale);
    collapse->moved = scaled_up(collapse->moved, scale);
  }
  measure_scaled(mesh, sequence);
  const float to_object = 1.0F / scale;
  for (Collapse* collapse : sequence.collapses) {
    collapse->guaranteed_error = scaled_up(collapse->guaranteed_error, to_object);
    collapse->moved = scaled_up(collapse->moved, to_object);
  }
  mesh.positions = std::move(positions);
}

}  // namespace occlod
