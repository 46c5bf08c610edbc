#include "splits/face_distance.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <utility>

namespace occlod {

LevelFaces::LevelFaces(const CollapseSequence& sequence) : sequence_(sequence) {
  list_ended();
  find_makers();
  // Counting sort by maker; afterwards first_made_[c + 1] has advanced to where the faces of the next maker begin.
  first_made_.assign(collapse_count() + 2, 0);
  for (FaceId f = 0; f < face_count(); ++f)
    if (const CollapseIndex c = maker(f); c != no_id) ++first_made_[c + 2];
  for (std::size_t c = 2; c < first_made_.size(); ++c) first_made_[c] += first_made_[c - 1];
  made_.resize(first_made_.back());
  for (FaceId f = 0; f < face_count(); ++f)
    if (const CollapseIndex c = maker(f); c != no_id) made_[first_made_[c + 1]++] = f;
  first_made_.pop_back();
}

void LevelFaces::list_ended() {
  for (const Collapse* collapse : sequence_.collapses) {
    first_ended_.push_back(face_count());
    for (std::uint32_t slot = 0; slot < collapse->ended_count(); ++slot)
      faces_.push_back({collapse->ended(slot), no_id});
  }
  first_ended_.push_back(face_count());
  for (const LevelFace& face : sequence_.base) faces_.push_back({face.corners, sequence_.place(face.made_by)});
}

void LevelFaces::find_makers() {
  for (CollapseIndex c = 0; c < collapse_count(); ++c)
    for (std::uint32_t slot = 0; collapse(c).is_fan() && slot < collapse(c).ended_count(); ++slot)
      if (const Collapse::EndedFace face = collapse(c).successor(slot); face.ended_by != no_id)
        faces_[first_ended_[sequence_.place(face.ended_by)] + face.slot].made_by = c;
  for (const MisplacedFace& face : sequence_.misplaced)
    faces_[first_ended_[sequence_.place(face.ended_by)] + face.slot].made_by = sequence_.place(face.made_by);
}

void PointBatch::resize(std::size_t count) {
  x.resize(count);
  y.resize(count);
  z.resize(count);
}

// Computes the frame in double precision, so that the frames of slivers are as exact as others. Only triangles whose
// normal is lost even then are replaced by their edges, which are part of them.
TriangleBatch::TriangleBatch(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) : origin_(a) {
  const std::array<glm::dvec3, 3> corners = {glm::dvec3(0.0), glm::dvec3(b) - glm::dvec3(a),
                                             glm::dvec3(c) - glm::dvec3(a)};
  const glm::dvec3 area = glm::cross(corners[1], corners[2]);
  const double twice_area = glm::length(area);
  double longest2 = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 edge = corners[(i + 1) % 3] - corners[i];
    longest2 = std::max(longest2, glm::dot(edge, edge));
  }
  longest_edge_ = static_cast<float>(std::sqrt(longest2));
  const bool has_inside = twice_area > 1e-6 * longest2;
  const glm::dvec3 normal = has_inside ? area / twice_area : glm::dvec3(0.0);
  normal_ = glm::vec3(normal);
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 along = corners[(i + 1) % 3] - corners[i];
    const double length2 = glm::dot(along, along);
    const double length = std::sqrt(length2);
    edges_[i] = {glm::vec3(corners[i]), glm::vec3(along),
                 has_inside ? glm::vec3(glm::cross(normal, along) / length) : glm::vec3(0.0F),
                 length2 > 1e-30 ? static_cast<float>(1.0 / length2) : 0.0F, has_inside ? 0.0F : -1.0F};
  }
}

// Uses only selects between values that are computed anyway, so that a loop over this has no branch.
inline float TriangleBatch::squared_distance(float x, float y, float z) const {
  x -= origin_.x;
  y -= origin_.y;
  z -= origin_.z;
  const auto least = [](float a, float b) { return a < b ? a : b; };
  const auto most = [](float a, float b) { return a > b ? a : b; };
  const auto depth = [&](const Edge& e) {
    return e.inwards.x * (x - e.start.x) + e.inwards.y * (y - e.start.y) + e.inwards.z * (z - e.start.z) + e.offset;
  };
  const auto squared_distance_to = [&](const Edge& e) {
    const float px = x - e.start.x, py = y - e.start.y, pz = z - e.start.z;
    const float along = (e.along.x * px + e.along.y * py + e.along.z * pz) * e.inverse_squared_length;
    const float t = least(most(along, 0.0F), 1.0F);
    const float dx = px - t * e.along.x, dy = py - t * e.along.y, dz = pz - t * e.along.z;
    return dx * dx + dy * dy + dz * dz;
  };
  const float height = normal_.x * x + normal_.y * y + normal_.z * z;
  const float height2 = height * height;
  const float inside = least(least(depth(edges_[0]), depth(edges_[1])), depth(edges_[2]));
  const float outside2 =
      least(least(squared_distance_to(edges_[0]), squared_distance_to(edges_[1])), squared_distance_to(edges_[2]));
  return inside >= 0.0F ? height2 : outside2;
}

// Works in runs: first distances, then choices, so that each loop is simple enough to vectorise.
void TriangleBatch::choose_nearer(const PointBatch& points, std::uint32_t number, float* __restrict least,
                                  std::uint32_t* __restrict chosen) const {
  constexpr std::size_t run = 256;
  std::array<float, run> squares;
  const TriangleBatch triangle = *this;  // a local copy cannot alias what is written
  for (std::size_t begin = 0; begin < points.size(); begin += run) {
    const float* const x = points.x.data() + begin;
    const float* const y = points.y.data() + begin;
    const float* const z = points.z.data() + begin;
    const std::size_t count = std::min(run, points.size() - begin);
    for (std::size_t i = 0; i < count; ++i) squares[i] = triangle.squared_distance(x[i], y[i], z[i]);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t nearer = squares[i] < least[begin + i] ? ~0U : 0U;
      chosen[begin + i] = (number & nearer) | (chosen[begin + i] & ~nearer);
      least[begin + i] = squares[i] < least[begin + i] ? squares[i] : least[begin + i];
    }
  }
}

TriangleBatch::Four TriangleBatch::squared_distances(const Four& x, const Four& y, const Four& z) const {
  Four squares;
  for (std::size_t i = 0; i < 4; ++i) squares[i] = squared_distance(x[i], y[i], z[i]);
  return squares;
}

float TriangleBatch::squared_distance(const glm::vec3& point) const {
  return squared_distance(point.x, point.y, point.z);
}

ReferenceMesh::ReferenceMesh(std::span<const glm::vec3> positions, const LevelFaces& levels, CollapseIndex time,
                             std::span<const float> maker_errors)
    : number_of_(positions.size(), no_id) {
  // Faces that ended before `time` are gone; of the others, those made before `time` exist.
  for (FaceId f = levels.first_ended(time); f < levels.face_count(); ++f) {
    const CollapseIndex maker = levels.maker(f);
    if (maker != no_id && maker >= time) continue;
    add_face(levels.corners(f), positions);
    errors_.push_back(maker == no_id ? 0.0F : maker_errors[maker]);
  }
  mean_error_ = std::accumulate(errors_.begin(), errors_.end(), 0.0) / static_cast<double>(face_count());
  link_stars();
}

void ReferenceMesh::add_face(const Triangle& corners, std::span<const glm::vec3> positions) {
  Triangle face;
  for (int k = 0; k < 3; ++k) {
    std::uint32_t& number = number_of_[corners[k]];
    if (number == no_id) {
      number = vertex_count();
      positions_.push_back(positions[corners[k]]);
    }
    face[k] = number;
  }
  faces_.push_back(face);
  const glm::vec3 &a = positions[corners.x], &b = positions[corners.y], &c = positions[corners.z];
  const glm::vec3 center = a + ((b - a) + (c - a)) * (1.0F / 3.0F);
  balls_.push_back({center, std::max({glm::distance(center, a), glm::distance(center, b), glm::distance(center, c)})});
}

void ReferenceMesh::link_stars() {
  first_star_.assign(positions_.size() + 2, 0);
  for (const Triangle& face : faces_)
    for (int k = 0; k < 3; ++k) ++first_star_[face[k] + 2];
  for (std::size_t v = 2; v < first_star_.size(); ++v) first_star_[v] += first_star_[v - 1];
  stars_.resize(first_star_.back());
  for (std::uint32_t f = 0; f < face_count(); ++f)
    for (int k = 0; k < 3; ++k) stars_[first_star_[faces_[f][k] + 1]++] = f;
  first_star_.pop_back();
}

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float near_exact = 1.125F;
// In radii of the widest face plus `wanted`: a wider piece is seldom near a single face, so it is halved without a
// test.
constexpr float too_wide = 0.35F;
// In units of `wanted`: how far away a face may be and still be considered.
constexpr float reach_of_faces = 0.6F;
constexpr std::size_t max_pieces = 1000;  // per triangle; if that is not enough the bound is loose

glm::vec3 centroid(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return a + ((b - a) + (c - a)) * (1.0F / 3.0F);
}

std::size_t longest_edge(const std::array<glm::vec3, 3>& piece) {
  std::size_t longest = 0;
  std::array<float, 3> squares;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::vec3 edge = piece[(i + 1) % 3] - piece[i];
    squares[i] = glm::dot(edge, edge);
    if (squares[i] > squares[longest]) longest = i;
  }
  return longest;
}

}  // namespace

float FaceDistance::bound(const Triangle& corners, float wanted, float useful) {
  wanted_ = wanted;
  useful_ = useful;
  at_least_ = 0.0F;
  bound_ = 0.0F;
  pieces_left_ = max_pieces;
  gather(corners);
  refine({mesh_.position(corners.x), mesh_.position(corners.y), mesh_.position(corners.z)}, 0);
  if (bound_ < useful) return bound_;
  return infinity;
}

// Gathers into near_ and candidates_ the faces near the triangle that are connected with its corners.
void FaceDistance::gather(const Triangle& corners) {
  near_.clear();
  triangles_.clear();
  widest_ = 0.0F;
  taken_.clear();
  candidates_.clear();
  const auto take_star = [&](std::uint32_t v) {
    for (const std::uint32_t f : mesh_.star(v))
      if (is_taken_[f] == 0) {
        is_taken_[f] = 1;
        taken_.push_back(f);
      }
  };
  for (int k = 0; k < 3; ++k) take_star(corners[k]);
  const TriangleBatch triangle(mesh_.position(corners.x), mesh_.position(corners.y), mesh_.position(corners.z));
  // taken_ grows during the loop.
  std::size_t next = 0;
  while (next < taken_.size()) {
    const std::uint32_t f = taken_[next++];
    const ReferenceMesh::Ball& ball = mesh_.ball(f);
    const float reach = reach_of_faces * wanted_ + ball.radius;
    if (triangle.squared_distance(ball.center) > reach * reach) continue;
    candidates_.push_back(static_cast<std::uint32_t>(near_.size()));
    near_.push_back({f, no_id});
    widest_ = std::max(widest_, ball.radius);
    for (int k = 0; k < 3; ++k) take_star(mesh_.corners(f)[k]);
  }
  for (const std::uint32_t f : taken_) is_taken_[f] = 0;
}

float FaceDistance::enough() const { return std::max(wanted_, near_exact * at_least_); }

const TriangleBatch& FaceDistance::triangle_of(NearFace& near) {
  if (near.triangle == no_id) {
    near.triangle = static_cast<std::uint32_t>(triangles_.size());
    const Triangle& t = mesh_.corners(near.face);
    triangles_.emplace_back(mesh_.position(t.x), mesh_.position(t.y), mesh_.position(t.z));
  }
  return triangles_[near.triangle];
}

// Refines one piece. Its candidates start at index `first`.
void FaceDistance::refine(const Piece& piece, std::size_t first) {
  const std::size_t end = candidates_.size();
  const glm::vec3 center = centroid(piece[0], piece[1], piece[2]);
  const float radius =
      std::max({glm::distance(center, piece[0]), glm::distance(center, piece[1]), glm::distance(center, piece[2])});
  const bool is_wide = radius > too_wide * (widest_ + wanted_);
  const float bound = is_wide ? infinity : measure(piece, center, first, end);
  if (bound <= enough() || pieces_left_ == 0 || at_least_ >= useful_) {
    bound_ = std::max(bound_, bound);
    return;
  }
  --pieces_left_;
  keep_close(center, radius, first, end);
  if (candidates_.size() == end)
    bound_ = std::max(bound_, bound);
  else
    halve(piece, end);
  candidates_.resize(end);
}

void FaceDistance::halve(const Piece& piece, std::size_t first) {
  const std::size_t i = longest_edge(piece);
  const glm::vec3 &a = piece[i], &b = piece[(i + 1) % 3], &apex = piece[(i + 2) % 3];
  const glm::vec3 middle = a + 0.5F * (b - a);
  refine({a, middle, apex}, first);
  if (bound_ < useful_) refine({middle, b, apex}, first);
}

// Appends those of the candidates [first, end) that can be close enough to some part of the piece, the most central one
// first, because it is often close enough to all of it.
void FaceDistance::keep_close(const glm::vec3& center, float radius, std::size_t first, std::size_t end) {
  const float reach = radius + enough();
  float nearest2 = infinity;
  for (std::size_t i = first; i < end; ++i) {
    const ReferenceMesh::Ball& ball = mesh_.ball(near_[candidates_[i]].face);
    const glm::vec3 between = ball.center - center;
    const float distance2 = glm::dot(between, between);
    const float both = reach + ball.radius;
    if (distance2 > both * both) continue;
    candidates_.push_back(candidates_[i]);
    if (distance2 < nearest2) std::swap(candidates_.back(), candidates_[end]);
    nearest2 = std::min(nearest2, distance2);
  }
}

// Returns a bound on the distance of the piece from the nearest candidate. Raises at_least_.
float FaceDistance::measure(const Piece& piece, const glm::vec3& center, std::size_t first, std::size_t end) {
  const TriangleBatch::Four x = {piece[0].x, piece[1].x, piece[2].x, center.x},
                            y = {piece[0].y, piece[1].y, piece[2].y, center.y},
                            z = {piece[0].z, piece[1].z, piece[2].z, center.z};
  float least = infinity, center_least = infinity;
  for (std::size_t i = first; i < end; ++i) {
    NearFace& near = near_[candidates_[i]];
    const TriangleBatch& triangle = triangle_of(near);
    const float error = mesh_.error(near.face);
    const TriangleBatch::Four squares = triangle.squared_distances(x, y, z);
    center_least = std::min(center_least, std::sqrt(squares[3]) + error);
    const float farthest2 = std::max({squares[0], squares[1], squares[2]});
    if (farthest2 >= least * least) continue;
    const float farthest = std::sqrt(farthest2);
    least = std::min(least, farthest + triangle.rounding(farthest) + error);
    if (least <= wanted_) return least;
  }
  at_least_ = std::max(at_least_, center_least);
  return least;
}

}  // namespace occlod
