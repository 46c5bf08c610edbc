#include "splits/collapse_rules.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

#include "splits/star.h"

namespace occlod {
namespace {

constexpr double min_cos_turn = 0.25;  // cosine of the largest turn of a face's normal in one collapse
// Squared sine below which the corner counts as collinear: three points on a line give such values by rounding.
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
  mesh.distinct_faces(v, faces_);
  degrees_.assign(neighbours_.size(), 0);
  for (const StarFace& f : faces_) {
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
  movable_ = (features == 0 || (features == 2 && constant)) && one_fan();
}

std::optional<std::size_t> VertexRing::place_of(VertexId u) const {
  const auto at = std::lower_bound(neighbours_.begin(), neighbours_.end(), u);
  if (at == neighbours_.end() || *at != u) return {};
  return static_cast<std::size_t>(at - neighbours_.begin());
}

bool VertexRing::one_fan() const {
  // Run union-find over the neighbours: every face at v joins two of them.
  fan_of_.resize(neighbours_.size());
  std::iota(fan_of_.begin(), fan_of_.end(), 0U);
  const auto root = [&](std::size_t i) {
    while (fan_of_[i] != i) i = fan_of_[i] = fan_of_[fan_of_[i]];
    return static_cast<std::uint32_t>(i);
  };
  std::size_t fans = neighbours_.size();
  for (const StarFace& f : faces_) {
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
  return ring.movable() && keeps_surface(mesh, ring, i);
}

bool keeps_surface(const StarMesh& mesh, const VertexRing& ring, std::size_t i) {
  const VertexId v = ring.vertex();
  const VertexId u = ring.neighbours()[i];
  if (ring.movable() && ring.on_feature() && ring.degree(i) == 2) return false;
  for (std::size_t k = 0; k < ring.neighbours().size(); ++k) {
    const VertexId w = ring.neighbours()[k];
    if (w == u) continue;
    const int degree_uw = mesh.edge_degree(u, w);
    if (degree_uw == 0) continue;
    // A vertex in both links must also be in the link of the edge.
    if (!has_face(mesh, v, u, w)) return false;
    // The edges to it must not both be feature edges; where surfaces touch, one of them must keep a face.
    const bool both = degree_uw != 2 && ring.degree(k) != 2, none_left = degree_uw == 1 && ring.degree(k) == 1;
    if (ring.movable() ? both : none_left) return false;
  }
  // The links must share no edge, so that no moved face meets an old one.
  for (const StarFace& f : ring.faces())
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

namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

double cross2(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

glm::dvec3 closest_on_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 ab = b - a;
  const double length2 = glm::dot(ab, ab);
  if (!(length2 > 0.0)) return a;
  return a + std::clamp(glm::dot(p - a, ab) / length2, 0.0, 1.0) * ab;
}

// Projects onto an orthonormal frame whose third axis is `normal` (unit).
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

double ChangeBound::operator()(const PositionView& positions, const VertexRing& ring, VertexId u) {
  const glm::dvec3 v(positions[ring.vertex()]);
  const glm::dvec3 target(positions[u]);
  const double slide = glm::distance(v, target);
  if (!ring.movable()) return slide;
  // After the collapse, the feature line runs from u to the neighbour on v's other side.
  glm::dvec3 apex = v;
  if (ring.on_feature())
    for (std::size_t i = 0; i < ring.neighbours().size(); ++i)
      if (ring.degree(i) != 2 && ring.neighbours()[i] != u)
        apex = closest_on_segment(v, target, glm::dvec3(positions[ring.neighbours()[i]]));
  double height = 0.0;
  open_faces_.assign(ring.faces().begin(), ring.faces().end());
  while (height < slide && !open_faces_.empty()) {
    if (!next_page(positions, ring)) return slide;
    height = std::max(height, page_bound(apex, target));
  }
  const double bound = std::min(slide, glm::distance(v, apex) + height);
  return bound * (1.0 + 1e-12);
}

// Takes the faces of one fan out of open_faces_ and puts their outer corners into page_ in order. Returns false when
// they do not form a fan.
bool ChangeBound::next_page(const PositionView& positions, const VertexRing& ring) {
  const auto is_feature = [&](VertexId w) {
    const auto neighbours = ring.neighbours();
    const auto at = std::lower_bound(neighbours.begin(), neighbours.end(), w);
    return ring.degree(static_cast<std::size_t>(at - neighbours.begin())) != 2;
  };
  // Starts at a feature edge if there is one, so that the walk to the other end covers the whole fan.
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

// Returns the largest height between the fan from `apex` and the fan from `target` (one of the corners) over the page's
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
  // Both fans must cover the same polygon once, so that no triangle is flipped. An old triangle may be perpendicular:
  // its heights are those of its edges.
  const double smallest = 1e-12 * length;
  for (std::size_t i = 0; i < edges; ++i) {
    const glm::dvec2& b = flat_[i];
    const glm::dvec2& c = flat_[(i + 1) % n];
    if (cross2(b - a, c - a) < -smallest) return unbounded;
    if (p[i] != target && p[(i + 1) % n] != target && !(cross2(b - t, c - t) > smallest)) return unbounded;
  }
  double largest = 0.0;
  bool apex_found = false;
  // The apex lies in exactly one new triangle (target, c_i, c_i+1) because the fan is checked; use the first that
  // contains it.
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
  // Old spokes (apex, c_i) cross new diagonals (target, c_j).
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
