#include "splits/face_distance.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace occlod {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float near_exact = 1.125F;
// In radii of the widest face and `wanted` together: a piece wider than that is seldom near one face, and is halved
// without a look.
constexpr float too_wide = 0.35F;
// Beside `wanted`: how far away a face may be and still be looked at.
constexpr float reach_of_faces = 0.6F;
constexpr std::size_t most_pieces = 1000;  // of one triangle; where that is not enough the bound is loose

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
  pieces_left_ = most_pieces;
  gather(corners);
  refine({mesh_.position(corners.x), mesh_.position(corners.y), mesh_.position(corners.z)}, 0);
  if (bound_ < useful) return bound_;
  return infinity;
}

// Into near_ and candidates_: the faces near the triangle, as far as they hang together with its corners.
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
  // taken_ grows on the way.
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

// The piece's candidates are those from `first` on.
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

// Appends those of the candidates [first, end) that can be near enough to some part of the piece, the most central one
// first: it is often near enough for all.
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

// A bound on the distance of the piece from the nearest candidate. Raises at_least_.
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
