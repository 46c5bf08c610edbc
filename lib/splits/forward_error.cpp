#include "splits/forward_error.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "splits/surface_samples.h"
#include "splits/triangle_batch.h"

namespace occlod {
namespace {

constexpr float round_up = 1.0F + 1e-5F;
// The floor in radii of the widest cell, at least 1. A cell that hangs over the edge of its face counts as away from it
// although another face is right there: errors about as small as cells are wide cannot be measured like this.
constexpr float floor_in_radii = 1.25F;

class ForwardPass {
 public:
  ForwardPass(const TriangleMesh& mesh, const LevelFaces& levels)
      : mesh_(mesh),
        levels_(levels),
        samples_(mesh, levels),
        next_(samples_.size(), no_id),
        charge_of_face_(levels.face_count(), no_id),
        charge_of_vertex_(mesh.vertex_count(), no_id),
        faces_at_(mesh.vertex_count(), 0) {
    samples_.place([&](FaceId f, SampleId s) { push(charge_of_face_[f], s); });
    for (const Triangle& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) ++faces_at_[t[k]];
  }

  ForwardErrors run() {
    ForwardErrors result;
    result.floor = floor_in_radii * samples_.max_radius();
    result.errors.reserve(levels_.collapse_count());
    for (CollapseIndex c = 0; c < levels_.collapse_count(); ++c) {
      take_charges(c);
      count_faces(c);
      result.errors.push_back(std::max(result.floor, hand_on(c, result.floor)));
    }
    return result;
  }

 private:
  void push(SampleId& head, SampleId s) {
    next_[s] = head;
    head = s;
  }

  void take(SampleId& head) {
    for (SampleId s = head; s != no_id; s = next_[s]) orphans_.push_back(s);
    head = no_id;
  }

  // Into orphans_: what was charged to the faces that collapse c ends and to the vertex that it removes.
  void take_charges(CollapseIndex c) {
    orphans_.clear();
    for (FaceId f = levels_.first_ended(c); f < levels_.first_ended(c + 1); ++f) take(charge_of_face_[f]);
    take(charge_of_vertex_[levels_.collapse(c).v]);
  }

  void count_faces(CollapseIndex c) {
    for (FaceId f = levels_.first_ended(c); f < levels_.first_ended(c + 1); ++f)
      for (int k = 0; k < 3; ++k) --faces_at_[levels_.corners(f)[k]];
    for (const FaceId f : levels_.made(c))
      for (int k = 0; k < 3; ++k) ++faces_at_[levels_.corners(f)[k]];
  }

  // Returns how far the cells are from what they are charged to now.
  float hand_on(CollapseIndex c, float floor) {
    if (orphans_.empty()) return 0.0F;
    const std::span<const FaceId> made = levels_.made(c);
    if (made.empty()) return hand_to_vertex(c);
    find_nearest(made);
    // The farthest sample first: few cells can be farther away than its own.
    const auto farthest =
        static_cast<std::size_t>(std::max_element(squares_.begin(), squares_.end()) - squares_.begin());
    float error = std::max(floor, cell_distance(farthest));
    for (std::size_t k = 0; k < orphans_.size(); ++k) {
      const SampleId s = orphans_[k];
      push(charge_of_face_[made[chosen_[k]]], s);
      const float distance = upper_bound(squares_[k], triangles_[chosen_[k]]);
      if ((distance + samples_.radius(s)) * round_up > error) error = std::max(error, cell_distance(k));
    }
    return error;
  }

  // An ear of a boundary, or two faces that cancel out: vertex u is still there as long as nothing removes it. Where
  // it has no face left its component has vanished, and with it the cells.
  float hand_to_vertex(CollapseIndex c) {
    const VertexId u = levels_.collapse(c).u;
    float error = levels_.collapse(c).moved;
    if (faces_at_[u] == 0) return error;
    const glm::vec3& p = mesh_.positions[u];
    for (const SampleId s : orphans_) {
      push(charge_of_vertex_[u], s);
      error = std::max(error, (glm::distance(samples_.point(s), p) + samples_.radius(s)) * round_up);
    }
    return error;
  }

  // Fills triangles_, and squares_ and chosen_ for each orphan.
  void find_nearest(std::span<const FaceId> made) {
    const std::size_t count = orphans_.size();
    points_.resize(count);
    for (std::size_t k = 0; k < count; ++k) points_.set(k, samples_.point(orphans_[k]));
    squares_.assign(count, std::numeric_limits<float>::infinity());
    chosen_.assign(count, 0);
    triangles_.clear();
    for (std::uint32_t i = 0; i < made.size(); ++i) {
      const Triangle& t = levels_.corners(made[i]);
      triangles_.emplace_back(mesh_.positions[t.x], mesh_.positions[t.y], mesh_.positions[t.z]);
      triangles_.back().choose_nearer(points_, i, squares_.data(), chosen_.data());
    }
  }

  static float upper_bound(float squared_distance, const TriangleBatch& triangle) {
    const float distance = std::sqrt(squared_distance);
    return (distance + triangle.rounding(distance)) * round_up;
  }

  // Of the k-th orphan's whole cell.
  float cell_distance(std::size_t k) {
    const TriangleBatch& triangle = triangles_[chosen_[k]];
    corners_.clear();
    samples_.append_corners(orphans_[k], corners_);
    float farthest2 = 0.0F;
    for (const glm::vec3& corner : corners_) farthest2 = std::max(farthest2, triangle.squared_distance(corner));
    return upper_bound(farthest2, triangle);
  }

  const TriangleMesh& mesh_;
  const LevelFaces& levels_;
  SurfaceSamples samples_;
  // Charges are lists of samples: one a face and, where nothing else is left, one a vertex.
  std::vector<SampleId> next_;
  std::vector<SampleId> charge_of_face_;
  std::vector<SampleId> charge_of_vertex_;
  std::vector<std::uint32_t> faces_at_;  // of each vertex

  // Scratch: the samples that lose their face, and for each the nearest of the new ones.
  std::vector<SampleId> orphans_;
  PointBatch points_;
  std::vector<float> squares_;
  std::vector<std::uint32_t> chosen_;
  std::vector<TriangleBatch> triangles_;
  std::vector<glm::vec3> corners_;
};

}  // namespace

ForwardErrors forward_errors(const TriangleMesh& mesh, const LevelFaces& levels) {
  return ForwardPass(mesh, levels).run();
}

}  // namespace occlod
