#include "splits/collapse_rules.h"

#include <algorithm>
#include <cassert>
#include <glm/geometric.hpp>
#include <numeric>

namespace occlod {
namespace {

constexpr double min_cos_turn = 0.25;  // cosine of the largest turn of a face's normal in one collapse
// A corner flatter than this, as the square of its sine, is what rounding makes of three points on a line.
constexpr double min_sin2_corner = 1e-11;

std::size_t index_of(std::span<const VertexId> sorted, VertexId v) {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), v);
  assert(at != sorted.end() && *at == v);
  return static_cast<std::size_t>(at - sorted.begin());
}

bool has_face(const StarMesh& mesh, VertexId a, VertexId b, VertexId c) {
  for (const StarFace f : mesh.star(a))
    if (contains(f, b) && contains(f, c)) return true;
  return false;
}

}  // namespace

void VertexRing::gather(const StarMesh& mesh, VertexId v) {
  vertex_ = v;
  mesh.neighbours(v, neighbours_);
  degrees_.assign(neighbours_.size(), 0);
  for (const StarFace f : mesh.star(v)) {
    ++degrees_[index_of(neighbours_, f.next)];
    ++degrees_[index_of(neighbours_, f.last)];
  }
  int features = 0;
  int feature_degree = 0;
  bool constant = true;
  for (const int degree : degrees_) {
    if (degree == 2) continue;
    constant = constant && (features == 0 || degree == feature_degree);
    feature_degree = degree;
    ++features;
  }
  on_feature_ = features > 0;
  movable_ = (features == 0 || (features == 2 && constant)) && one_fan(mesh);
}

std::optional<std::size_t> VertexRing::place_of(VertexId u) const {
  const auto at = std::lower_bound(neighbours_.begin(), neighbours_.end(), u);
  if (at == neighbours_.end() || *at != u) return {};
  return static_cast<std::size_t>(at - neighbours_.begin());
}

bool VertexRing::one_fan(const StarMesh& mesh) const {
  // Union-find over the neighbours; every face at v joins two of them.
  fan_of_.resize(neighbours_.size());
  std::iota(fan_of_.begin(), fan_of_.end(), 0U);
  const auto root = [&](std::size_t i) {
    while (fan_of_[i] != i) i = fan_of_[i] = fan_of_[fan_of_[i]];
    return static_cast<std::uint32_t>(i);
  };
  std::size_t fans = neighbours_.size();
  for (const StarFace f : mesh.star(vertex_)) {
    const std::uint32_t a = root(index_of(neighbours_, f.next));
    const std::uint32_t b = root(index_of(neighbours_, f.last));
    if (a == b) continue;
    fan_of_[a] = b;
    --fans;
  }
  return fans == 1;
}

bool has_inserted_star(const StarMesh& mesh, const SplitStar& star) {
  const VertexId v = star.vertex();
  const Star now = mesh.star(v);
  std::size_t count = 0;
  for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot) {
    if (!contains(star.inserted(slot), v)) continue;
    const Triangle t = rotated(star.inserted(slot), v);
    bool is_there = false;
    for (const StarFace f : now) is_there = is_there || (f.next == t.y && f.last == t.z);
    if (!is_there) return false;
    ++count;
  }
  return count == now.size();
}

bool keeps_topology(const StarMesh& mesh, const VertexRing& ring, std::size_t i) {
  const VertexId v = ring.vertex();
  const VertexId u = ring.neighbours()[i];
  if (!ring.movable() || (ring.on_feature() && ring.degree(i) == 2)) return false;
  for (std::size_t k = 0; k < ring.neighbours().size(); ++k) {
    const VertexId w = ring.neighbours()[k];
    if (w == u) continue;
    const int degree_uw = mesh.edge_degree(u, w);
    if (degree_uw == 0) continue;
    // A vertex of both links is one of the edge's link, and the edges to it are not both features.
    if (!has_face(mesh, v, u, w) || (degree_uw != 2 && ring.degree(k) != 2)) return false;
  }
  // No edge is in both links: no moved face meets an old one.
  for (const StarFace f : mesh.star(v))
    if (!contains(f, u) && has_face(mesh, u, f.next, f.last)) return false;
  return true;
}

bool keeps_orientation(const StarMesh& mesh, const PositionView& positions, VertexId v, VertexId u) {
  const glm::dvec3 from(positions[v]);
  const glm::dvec3 to(positions[u]);
  for (const StarFace f : mesh.star(v)) {
    if (contains(f, u)) continue;
    const glm::dvec3 a(positions[f.next]);
    const glm::dvec3 edge = glm::dvec3(positions[f.last]) - a;
    const glm::dvec3 before = glm::cross(edge, from - a);
    const glm::dvec3 after = glm::cross(edge, to - a);
    const double area_before = glm::dot(before, before);
    if (area_before == 0.0) continue;
    const glm::dvec3 side = to - a;
    if (!(glm::dot(after, after) > min_sin2_corner * glm::dot(edge, edge) * glm::dot(side, side))) return false;
    const double turn = glm::dot(before, after);
    if (!(turn > 0.0 && turn * turn >= min_cos_turn * min_cos_turn * area_before * glm::dot(after, after)))
      return false;
  }
  return true;
}

}  // namespace occlod
