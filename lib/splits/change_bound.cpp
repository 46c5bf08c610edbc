#include "splits/change_bound.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace occlod {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

double cross2(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

glm::dvec3 closest_on_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 ab = b - a;
  const double length2 = glm::dot(ab, ab);
  if (!(length2 > 0.0)) return a;
  return a + std::clamp(glm::dot(p - a, ab) / length2, 0.0, 1.0) * ab;
}

// An orthonormal frame whose third axis is `normal` (unit).
struct Projection {
  glm::dvec3 x, y;
  explicit Projection(const glm::dvec3& normal) {
    const glm::dvec3 other = std::abs(normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    x = glm::normalize(glm::cross(other, normal));
    y = glm::cross(normal, x);
  }
  [[nodiscard]] glm::dvec2 operator()(const glm::dvec3& p) const { return {glm::dot(p, x), glm::dot(p, y)}; }
};

}  // namespace

double ChangeBound::operator()(const StarMesh& mesh, const PositionView& positions, const VertexRing& ring,
                               VertexId u) {
  const glm::dvec3 v(positions[ring.vertex()]);
  const glm::dvec3 target(positions[u]);
  const double slide = glm::distance(v, target);
  if (!ring.movable()) return slide;
  // Where the feature line runs once v is gone: from u to the neighbour on v's other side.
  glm::dvec3 apex = v;
  if (ring.on_feature())
    for (std::size_t i = 0; i < ring.neighbours().size(); ++i)
      if (ring.degree(i) != 2 && ring.neighbours()[i] != u)
        apex = closest_on_segment(v, target, glm::dvec3(positions[ring.neighbours()[i]]));
  double height = 0.0;
  open_faces_.clear();
  for (const StarFace f : mesh.star(ring.vertex())) open_faces_.push_back(f);
  while (height < slide && !open_faces_.empty()) {
    if (!next_page(positions, ring)) return slide;
    height = std::max(height, page_bound(apex, target));
  }
  const double bound = std::min(slide, glm::distance(v, apex) + height);
  return bound * (1.0 + 1e-12);
}

// Takes the faces of one fan out of open_faces_ and puts their outer corners into page_ in order. False when they do
// not form a fan.
bool ChangeBound::next_page(const PositionView& positions, const VertexRing& ring) {
  const auto is_feature = [&](VertexId w) {
    const auto neighbours = ring.neighbours();
    const auto at = std::lower_bound(neighbours.begin(), neighbours.end(), w);
    return ring.degree(static_cast<std::size_t>(at - neighbours.begin())) != 2;
  };
  // Start at a feature edge if there is one, so that the walk to the other end covers the whole fan.
  VertexId start = no_id;
  for (const StarFace& f : open_faces_) {
    if (is_feature(f.next)) start = f.next;
    if (is_feature(f.last)) start = f.last;
  }
  page_.closed = start == no_id;
  if (page_.closed) start = open_faces_[0].next;
  page_.corners.assign(1, glm::dvec3(positions[start]));
  VertexId at = start;
  do {
    const auto f =
        std::find_if(open_faces_.begin(), open_faces_.end(), [&](const StarFace& face) { return contains(face, at); });
    if (f == open_faces_.end()) return false;
    at = f->next == at ? f->last : f->next;
    *f = open_faces_.back();
    open_faces_.pop_back();
    if (at != start) page_.corners.emplace_back(positions[at]);
  } while (at != start && !is_feature(at));
  return true;
}

// The largest height between the fan from `apex` and the fan from `target` (one of the corners) over the page's
// polygon.
double ChangeBound::page_bound(const glm::dvec3& apex, const glm::dvec3& target) {
  const std::vector<glm::dvec3>& p = page_.corners;
  const std::size_t n = p.size();
  const std::size_t edges = page_.closed ? n : n - 1;
  if (edges == 1) return 0.0;  // the only face slides onto the feature line, which stays
  glm::dvec3 normal(0.0);
  for (std::size_t i = 0; i < edges; ++i) normal += glm::cross(p[i] - apex, p[(i + 1) % n] - apex);
  const double length = glm::length(normal);
  if (!(length > 0.0)) return unbounded;
  const Projection project(normal / length);
  const glm::dvec2 a = project(apex);
  const glm::dvec2 t = project(target);
  flat_.resize(n);
  std::transform(p.begin(), p.end(), flat_.begin(), [&](const glm::dvec3& corner) { return project(corner); });
  // Both fans must cover the same polygon once: no triangle is flipped. An old one may be perpendicular: its heights
  // are those of its edges.
  const double smallest = 1e-12 * length;
  for (std::size_t i = 0; i < edges; ++i) {
    const glm::dvec2& b = flat_[i];
    const glm::dvec2& c = flat_[(i + 1) % n];
    if (cross2(b - a, c - a) < -smallest) return unbounded;
    if (p[i] != target && p[(i + 1) % n] != target && !(cross2(b - t, c - t) > smallest)) return unbounded;
  }
  double largest = 0.0;
  bool apex_found = false;
  // The apex lies in one new triangle (target, c_i, c_i+1); the fan is checked, so in the first that holds it.
  for (std::size_t i = 0; i < edges; ++i) {
    const std::size_t j = (i + 1) % n;
    if (p[i] == target || p[j] == target) continue;
    const glm::dvec2 b = flat_[i] - t, c = flat_[j] - t, q = a - t;
    const double area = cross2(b, c);
    const double s = cross2(q, c) / area, r = cross2(b, q) / area;
    if (s < -1e-9 || r < -1e-9 || s + r > 1.0 + 1e-9) continue;
    largest = std::max(largest, glm::distance(apex, target + s * (p[i] - target) + r * (p[j] - target)));
    apex_found = true;
  }
  if (!apex_found) return unbounded;
  // Crossings of an old spoke (apex, c_i) with a new diagonal (target, c_j).
  for (std::size_t j = 0; j < n; ++j) {
    if (p[j] == target) continue;
    const glm::dvec2 diagonal = flat_[j] - t;
    for (std::size_t i = 0; i < n; ++i) {
      if (i == j || p[i] == target) continue;
      const glm::dvec2 spoke = flat_[i] - a;
      const double det = cross2(diagonal, spoke);
      if (det == 0.0) continue;
      const glm::dvec2 between = a - t;
      const double along_new = cross2(between, spoke) / det;
      const double along_old = cross2(between, diagonal) / det;
      if (along_new <= 0.0 || along_new >= 1.0 || along_old <= 0.0 || along_old >= 1.0) continue;
      largest =
          std::max(largest, glm::distance(apex + along_old * (p[i] - apex), target + along_new * (p[j] - target)));
    }
  }
  return largest;
}

}  // namespace occlod
