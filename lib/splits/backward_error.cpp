#include "splits/backward_error.h"

#include <algorithm>
#include <memory>

#include "splits/face_distance.h"
#include "splits/reference_mesh.h"

namespace occlod {
namespace {

constexpr float round_up = 1.0F + 1e-6F;
// The sequence's meshes are kept at every halving of the number of faces, the latest of them.
constexpr std::size_t most_references = 4;
// Faces are measured against the coarsest that has so many times as many as there are now. Its errors add to what is
// measured; finer ones are tighter and take longer.
constexpr std::size_t reference_ratio = 4;
// What may be added up before a face is measured, and how closely it is measured then, beside what is wanted. The gap
// lets several collapses pass before the next measurement.
constexpr float tolerated = 1.5F;
constexpr float goal = 0.9F;

struct Reference {
  Reference(const TriangleMesh& input, const LevelFaces& levels, CollapseIndex time, std::span<const float> errors)
      : mesh(input.positions, levels, time, errors), distance(mesh) {}
  ReferenceMesh mesh;
  FaceDistance distance;
};

class BackwardPass {
 public:
  BackwardPass(const TriangleMesh& mesh, const LevelFaces& levels, std::span<const float> wanted)
      : mesh_(mesh), levels_(levels), wanted_(wanted), faces_(mesh.triangle_count()) {
    renew(0);
  }

  std::vector<float> run() {
    errors_.reserve(levels_.collapse_count());
    for (CollapseIndex c = 0; c < levels_.collapse_count(); ++c) {
      errors_.push_back(error_of(c));
      faces_ -= levels_.first_ended(c + 1) - levels_.first_ended(c);
      faces_ += levels_.made(c).size();
      if (faces_ <= renew_at_) renew(c + 1);
    }
    return std::move(errors_);
  }

 private:
  [[nodiscard]] float error_of(CollapseIndex c) {
    float before = 0.0F;
    for (FaceId f = levels_.first_ended(c); f < levels_.first_ended(c + 1); ++f)
      if (const CollapseIndex maker = levels_.maker(f); maker != no_id) before = std::max(before, errors_[maker]);
    const float accumulated = (before + levels_.collapse(c).moved) * round_up;
    if (accumulated <= tolerated * wanted_[c]) return accumulated;
    Reference& reference = *references_[reference_index()];
    float error = 0.0F;
    for (const FaceId f : levels_.made(c)) {
      const Triangle& t = levels_.corners(f);
      const ReferenceMesh& mesh = reference.mesh;
      const Triangle corners(mesh.vertex_of(t.x), mesh.vertex_of(t.y), mesh.vertex_of(t.z));
      error = std::max(error, reference.distance.bound(corners, goal * wanted_[c], accumulated));
      if (error >= accumulated) return accumulated;
    }
    return error;
  }

  [[nodiscard]] std::size_t reference_index() const {
    std::size_t i = references_.size() - 1;
    while (i > 0 && references_[i]->mesh.face_count() < reference_ratio * faces_) --i;
    return i;
  }

  void renew(CollapseIndex time) {
    if (references_.size() == most_references) references_.erase(references_.begin());
    references_.push_back(std::make_unique<Reference>(mesh_, levels_, time, errors_));
    renew_at_ = faces_ / 2;
  }

  const TriangleMesh& mesh_;
  const LevelFaces& levels_;
  std::span<const float> wanted_;
  std::size_t faces_;         // of the mesh before the next collapse
  std::size_t renew_at_ = 0;  // faces
  std::vector<float> errors_;
  std::vector<std::unique_ptr<Reference>> references_;  // from fine to coarse
};

}  // namespace

std::vector<float> backward_errors(const TriangleMesh& mesh, const LevelFaces& levels, std::span<const float> wanted) {
  return BackwardPass(mesh, levels, wanted).run();
}

}  // namespace occlod
