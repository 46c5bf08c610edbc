#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "occlod/mesh.h"
#include "splits/build_steps.h"
#include "splits/face_distance.h"
#include "splits/positions.h"
#include "splits/star_mesh.h"

namespace occlod {
namespace {

// Cuts an input mesh into small cells, each around one sample point.

using SampleId = std::uint32_t;

// The cell of a vertex is its share of its triangles: in each, the quadrilateral between the vertex, the midpoints of
// two edges and the centroid. Triangles with an edge longer than a limit are instead cut into a regular lattice of
// small triangles, each a cell around its own centroid. The limit is the smallest that keeps the number of lattice
// cells at most an eighth of the number of triangles. Keeps references to mesh and levels.
class SurfaceSamples {
 public:
  SurfaceSamples(const TriangleMesh& mesh, const LevelFaces& levels);

  [[nodiscard]] std::size_t size() const noexcept { return radii_.size(); }
  [[nodiscard]] glm::vec3 point(SampleId s) const noexcept {
    return s < mesh_.vertex_count() ? mesh_.positions[s] : lattice_[s - mesh_.vertex_count()].point;
  }
  // Returns the radius of a ball around the point that contains the cell. Negative: the vertex has no cell.
  [[nodiscard]] float radius(SampleId s) const noexcept { return radii_[s]; }
  [[nodiscard]] float max_radius() const noexcept { return max_radius_; }
  // Calls put(face, sample) for every sample that has a cell, with one face of the input that contains the point.
  template <typename Put>
  void place(const Put& put) const;
  // Appends the corners of the cell's convex pieces: no point of the cell is farther from a triangle than they are.
  void append_corners(SampleId s, std::vector<glm::vec3>& out) const;

 private:
  struct LatticeCell {
    FaceId face;
    std::uint32_t number;  // index in the lattice of its triangle, row by row
    glm::vec3 point;
  };
  using Corners = std::array<glm::vec3, 3>;

  [[nodiscard]] float longest_edge(const Triangle& t) const;
  [[nodiscard]] std::uint32_t divisions(const Triangle& t) const;
  [[nodiscard]] Corners lattice_corners(const Triangle& t, std::uint32_t number) const;
  void choose_limit();
  void link_stars();
  void add_lattices();

  const TriangleMesh& mesh_;
  const LevelFaces& levels_;
  float limit_ = 0.0F;  // longest edge of a triangle that is divided among its corners
  std::vector<std::uint32_t> first_star_;
  std::vector<std::uint32_t> stars_;  // the divided triangles at each vertex
  std::vector<LatticeCell> lattice_;
  std::vector<float> radii_;
  float max_radius_ = 0.0F;
};

template <typename Put>
void SurfaceSamples::place(const Put& put) const {
  std::vector<bool> placed(mesh_.vertex_count(), false);
  for (FaceId f = 0; f < levels_.face_count(); ++f) {
    if (levels_.maker(f) != no_id || longest_edge(levels_.corners(f)) > limit_) continue;
    for (int k = 0; k < 3; ++k) {
      const VertexId v = levels_.corners(f)[k];
      if (!placed[v]) put(f, v);
      placed[v] = true;
    }
  }
  for (std::size_t i = 0; i < lattice_.size(); ++i)
    put(lattice_[i].face, static_cast<SampleId>(mesh_.vertex_count() + i));
}

constexpr float round_up = 1.0F + 1e-5F;
constexpr double max_lattice_cells = 1.0 / 8.0;  // as a fraction of the number of triangles

glm::vec3 centroid(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return a + ((b - a) + (c - a)) * (1.0F / 3.0F);
}

glm::vec3 middle(const glm::vec3& a, const glm::vec3& b) { return a + (b - a) * 0.5F; }

SurfaceSamples::SurfaceSamples(const TriangleMesh& mesh, const LevelFaces& levels) : mesh_(mesh), levels_(levels) {
  choose_limit();
  link_stars();
  radii_.assign(mesh.vertex_count(), -1.0F);
  std::vector<glm::vec3> corners;
  for (SampleId v = 0; v < mesh.vertex_count(); ++v) {
    corners.clear();
    append_corners(v, corners);
    for (const glm::vec3& corner : corners) radii_[v] = std::max(radii_[v], glm::distance(corner, mesh.positions[v]));
    radii_[v] *= round_up;
  }
  add_lattices();
  max_radius_ = std::max(0.0F, *std::max_element(radii_.begin(), radii_.end()));
}

float SurfaceSamples::longest_edge(const Triangle& t) const {
  const glm::vec3 &a = mesh_.positions[t.x], &b = mesh_.positions[t.y], &c = mesh_.positions[t.z];
  return std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
}

std::uint32_t SurfaceSamples::divisions(const Triangle& t) const {
  return static_cast<std::uint32_t>(std::ceil(longest_edge(t) / limit_));
}

// Starts at the root mean square of the longest edges, so that an even mesh gets few lattices.
void SurfaceSamples::choose_limit() {
  std::vector<float> lengths;
  lengths.reserve(mesh_.triangle_count());
  for (const Triangle& t : mesh_.triangles) lengths.push_back(longest_edge(t));
  double squares = 0.0;
  for (const float length : lengths) squares += static_cast<double>(length) * length;
  double limit = std::sqrt(squares / static_cast<double>(lengths.size()));
  const double most = max_lattice_cells * static_cast<double>(lengths.size()) + 16.0;
  const auto cells = [&] {
    double sum = 0.0;
    for (const float length : lengths)
      if (length > limit) sum += std::pow(std::ceil(length / limit), 2.0);
    return sum;
  };
  while (cells() > most) limit *= 1.1;
  limit_ = static_cast<float>(limit);
}

void SurfaceSamples::link_stars() {
  first_star_.assign(mesh_.vertex_count() + 2, 0);
  const auto for_each_corner = [&](const auto& visit) {
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      if (longest_edge(mesh_.triangles[t]) <= limit_)
        for (int k = 0; k < 3; ++k) visit(mesh_.triangles[t][k], t);
  };
  for_each_corner([&](VertexId v, std::uint32_t) { ++first_star_[v + 2]; });
  for (std::size_t v = 2; v < first_star_.size(); ++v) first_star_[v] += first_star_[v - 1];
  stars_.resize(first_star_.back());
  for_each_corner([&](VertexId v, std::uint32_t t) { stars_[first_star_[v + 1]++] = t; });
  first_star_.pop_back();
}

void SurfaceSamples::add_lattices() {
  for (FaceId f = 0; f < levels_.face_count(); ++f) {
    const Triangle& t = levels_.corners(f);
    if (levels_.maker(f) != no_id || longest_edge(t) <= limit_) continue;
    const std::uint32_t n = divisions(t);
    for (std::uint32_t number = 0; number < n * n; ++number) {
      const Corners c = lattice_corners(t, number);
      const glm::vec3 point = centroid(c[0], c[1], c[2]);
      lattice_.push_back({f, number, point});
      radii_.push_back(std::max({glm::distance(point, c[0]), glm::distance(point, c[1]), glm::distance(point, c[2])}) *
                       round_up);
    }
  }
}

// Returns the corners of one lattice triangle. Row i, with i = 0 at corner x, has 2 i + 1 triangles, every other one
// upside down; i^2 triangles lie before it.
SurfaceSamples::Corners SurfaceSamples::lattice_corners(const Triangle& t, std::uint32_t number) const {
  const auto row = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(number)));
  const std::uint32_t column = number - row * row;
  const float step = 1.0F / static_cast<float>(divisions(t));
  const glm::vec3& origin = mesh_.positions[t.x];
  const glm::vec3 down = (mesh_.positions[t.y] - origin) * step;
  const glm::vec3 right = (mesh_.positions[t.z] - mesh_.positions[t.y]) * step;
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    return origin + down * static_cast<float>(i) + right * static_cast<float>(j);
  };
  const std::uint32_t j = column / 2;
  if (column % 2 == 0) return {at(row, j), at(row + 1, j), at(row + 1, j + 1)};
  return {at(row, j), at(row + 1, j + 1), at(row, j + 1)};
}

void SurfaceSamples::append_corners(SampleId s, std::vector<glm::vec3>& out) const {
  if (s >= mesh_.vertex_count()) {
    const LatticeCell& cell = lattice_[s - mesh_.vertex_count()];
    const Corners corners = lattice_corners(levels_.corners(cell.face), cell.number);
    out.insert(out.end(), corners.begin(), corners.end());
    return;
  }
  const glm::vec3& p = mesh_.positions[s];
  for (std::uint32_t i = first_star_[s]; i < first_star_[s + 1]; ++i) {
    const Triangle t = rotated(mesh_.triangles[stars_[i]], s);
    const glm::vec3 &next = mesh_.positions[t.y], &last = mesh_.positions[t.z];
    out.insert(out.end(), {p, middle(p, next), centroid(p, next, last), middle(p, last)});
  }
}

// Bounds the distance of the input from any cut: one half of the guaranteed error.

// In every cut, each cell of the input (see SurfaceSamples) is assigned to exactly one face. It starts with a face that
// contains its sample; when a collapse ends that face, the nearest of the faces that the collapse makes takes over.
struct ForwardErrors {
  // per collapse: a bound on the distance between the faces that it made and every cell assigned to them; at least
  // `floor`
  std::vector<float> errors;
  float floor = 0.0F;  // exceeds the distance of any cell from the input face it starts with
};

// The floor in radii of the widest cell, at least 1. A cell that extends over the edge of its face counts as away from
// it although another face is right there, so errors of about the cell size cannot be measured like this.
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

  // Moves into orphans_ the samples assigned to the faces that collapse c ends and to the vertex that it removes.
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

  // Assigns the orphans to new faces. Returns the largest distance of a cell from the face to which it is now assigned.
  float hand_on(CollapseIndex c, float floor) {
    if (orphans_.empty()) return 0.0F;
    const std::span<const FaceId> made = levels_.made(c);
    if (made.empty()) return hand_to_vertex(c);
    find_nearest(made);
    // Starts with the farthest sample, because few cells can extend farther than its own.
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

  // Assigns the orphans to vertex u, at an ear of a boundary or where two faces cancel out: u exists as long as nothing
  // removes it. Where u has no face left, another corner of the ended faces takes over, since what vanishes may hang by
  // that corner. Where none has a face, the component has vanished, and the cells with it.
  float hand_to_vertex(CollapseIndex c) {
    float error = levels_.collapse(c).moved;
    const VertexId u = corner_left(c);
    if (u == no_id) return error;
    const glm::vec3& p = mesh_.positions[u];
    for (const SampleId s : orphans_) {
      push(charge_of_vertex_[u], s);
      error = std::max(error, (glm::distance(samples_.point(s), p) + samples_.radius(s)) * round_up);
    }
    return error;
  }

  // Returns u, or the corner of an ended face that is nearest to it and has faces; no_id when none has.
  [[nodiscard]] VertexId corner_left(CollapseIndex c) const {
    const VertexId u = levels_.collapse(c).u;
    if (faces_at_[u] > 0) return u;
    VertexId nearest = no_id;
    const auto distance = [&](VertexId w) { return glm::distance(mesh_.positions[w], mesh_.positions[u]); };
    for (FaceId f = levels_.first_ended(c); f < levels_.first_ended(c + 1); ++f)
      for (int k = 0; k < 3; ++k)
        if (const VertexId w = levels_.corners(f)[k];
            faces_at_[w] > 0 && (nearest == no_id || distance(w) < distance(nearest)))
          nearest = w;
    return nearest;
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

  // Returns the distance of the k-th orphan's whole cell.
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
  // Links the samples assigned to one face, or to one vertex where no face is left, into a list.
  std::vector<SampleId> next_;
  std::vector<SampleId> charge_of_face_;
  std::vector<SampleId> charge_of_vertex_;
  std::vector<std::uint32_t> faces_at_;  // per vertex

  // Scratch: the samples that lose their face, and for each the nearest of the new faces.
  std::vector<SampleId> orphans_;
  PointBatch points_;
  std::vector<float> squares_;
  std::vector<std::uint32_t> chosen_;
  std::vector<TriangleBatch> triangles_;
  std::vector<glm::vec3> corners_;
};

[[nodiscard]] ForwardErrors forward_errors(const TriangleMesh& mesh, const LevelFaces& levels) {
  return ForwardPass(mesh, levels).run();
}

// Bounds the distance of any cut from the input: the other half of the guaranteed error.

constexpr float round_sum_up = 1.0F + 1e-6F;
// Reference meshes are kept at every halving of the number of faces; only the latest of them stay.
constexpr std::size_t max_references = 4;
// Faces are measured against the coarsest reference that has at least this many times as many faces as the current
// mesh. A reference's own errors add to the measured distance; finer references are tighter and take longer.
constexpr std::size_t reference_ratio = 4;
// Limit of what is accumulated before a face is measured, and precision of the measurement, both relative to `wanted`.
// The gap lets several collapses pass before the next measurement.
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
    const float accumulated = (before + levels_.collapse(c).moved) * round_sum_up;
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
    if (references_.size() == max_references) references_.erase(references_.begin());
    references_.push_back(std::make_unique<Reference>(mesh_, levels_, time, errors_));
    renew_at_ = faces_ / 2;
  }

  const TriangleMesh& mesh_;
  const LevelFaces& levels_;
  std::span<const float> wanted_;
  std::size_t faces_;         // in the mesh before the next collapse
  std::size_t renew_at_ = 0;  // number of faces
  std::vector<float> errors_;
  std::vector<std::unique_ptr<Reference>> references_;  // from fine to coarse
};

// Returns, for each collapse, a bound on the distance of every point of the faces that it made from the input: the
// bound of the faces that it ended plus its own movement, or, where that is much more than `wanted`, the distance
// measured against a finer mesh of the sequence.
[[nodiscard]] std::vector<float> backward_errors(const TriangleMesh& mesh, const LevelFaces& levels,
                                                 std::span<const float> wanted) {
  return BackwardPass(mesh, levels, wanted).run();
}

// Raises each error to at least those of the collapses on which it depends.
std::vector<float> saturated(const LevelFaces& levels, std::vector<float> errors) {
  for (CollapseIndex c = 0; c < levels.collapse_count(); ++c)
    for (FaceId f = levels.first_ended(c); f < levels.first_ended(c + 1); ++f)
      if (const CollapseIndex maker = levels.maker(f); maker != no_id) errors[c] = std::max(errors[c], errors[maker]);
  return errors;
}

// Bounds the rounding error of points computed in single precision, wherever the mesh is.
float position_rounding(const TriangleMesh& mesh) {
  float largest = 0.0F;
  for (const glm::vec3& p : mesh.positions) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return 16.0F * std::numeric_limits<float>::epsilon() * largest;
}

// Measures a mesh and a sequence whose units keep squares in range.
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
