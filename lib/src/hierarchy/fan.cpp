#include "fan.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace occlod {
namespace {

// As in collapse_rules.cpp.
constexpr float min_cos_turn = 0.25F;
constexpr float min_sin2_corner = 1e-11F;
constexpr float round_up = 1.0F + 1e-5F;

float cross2(const glm::vec2& a, const glm::vec2& b) { return a.x * b.y - a.y * b.x; }

}  // namespace

bool Fan::gather(const StarMesh& mesh, VertexId v) {
  vertex_ = v;
  const auto star = mesh.star(v);
  size_ = star.size();
  if (size_ < 3 || size_ > most_neighbours) return false;
  std::array<OppositeEdge, most_neighbours> edges;
  for (std::size_t i = 0; i < size_; ++i) edges[i] = opposite_edge(mesh.face(star[i]), v);
  // Chain the outer edges: each must start where the one before ended, and the last must end at the start.
  ring_[0] = edges[0].next;
  for (std::size_t i = 1; i < size_; ++i) {
    const VertexId from = edges[i - 1].last;
    // Closed too early: there is another fan, or the ring passes a neighbour twice.
    if (std::find(ring_.begin(), ring_.begin() + static_cast<std::ptrdiff_t>(i), from) !=
        ring_.begin() + static_cast<std::ptrdiff_t>(i))
      return false;
    std::size_t k = i;
    while (k < size_ && edges[k].next != from) ++k;
    if (k == size_) return false;
    std::swap(edges[i], edges[k]);
    ring_[i] = from;
  }
  return edges[size_ - 1].last == ring_[0];
}

void Fan::measure(std::span<const glm::vec3> positions) {
  const glm::vec3 origin = positions[vertex_];
  for (std::size_t i = 0; i < size_; ++i) offsets_[i] = positions[ring_[i]] - origin;
  for (std::size_t i = 0; i < size_; ++i) normals_[i] = glm::cross(offsets_[i], offsets_[after(i)]);
}

// The vertex is inside the surface, so its link is the ring, and only the plain link condition is left: the ring meets
// the link of ring_[i] in the two corners beside it, and in no edge.
bool Fan::keeps_topology(const StarMesh& mesh, std::size_t i) const {
  const VertexId u = ring_[i];
  const VertexId left = ring_[before(i)], right = ring_[after(i)];
  const auto is_elsewhere_in_ring = [&](VertexId w) {
    return w != left && w != right &&
           std::find(ring_.begin(), ring_.begin() + static_cast<std::ptrdiff_t>(size_), w) !=
               ring_.begin() + static_cast<std::ptrdiff_t>(size_);
  };
  for (const FaceId f : mesh.star(u)) {
    const Triangle& t = mesh.face(f);
    if (contains(t, vertex_)) continue;
    const OppositeEdge e = opposite_edge(t, u);
    if (is_elsewhere_in_ring(e.next) || is_elsewhere_in_ring(e.last)) return false;
    if (size_ == 3 && contains(t, left) && contains(t, right)) return false;  // a tetrahedron would fold flat
  }
  return true;
}

bool Fan::keeps_orientation(std::size_t i) const {
  const glm::vec3& target = offsets_[i];
  for (std::size_t k = after(i); k != before(i); k = after(k)) {
    const glm::vec3& normal = normals_[k];
    const float area2 = glm::dot(normal, normal);
    if (area2 == 0.0F) continue;
    const glm::vec3 a = offsets_[k] - target, b = offsets_[after(k)] - target;
    const glm::vec3 moved = glm::cross(a, b);
    const float moved2 = glm::dot(moved, moved);
    const float turn = glm::dot(normal, moved);
    if (!(turn > 0.0F && turn * turn >= min_cos_turn * min_cos_turn * area2 * moved2)) return false;
    if (!(moved2 > min_sin2_corner * glm::dot(a, a) * glm::dot(b, b))) return false;
  }
  return true;
}

// See change_bound.h. The apex is the origin; the polygon is the ring; new triangles are fans from the target.
float Fan::change_bound(std::size_t i) const {
  const glm::vec3 target = offsets_[i];
  const float slide = glm::length(target) * round_up;
  glm::vec3 normal(0.0F);
  for (std::size_t k = 0; k < size_; ++k) normal += normals_[k];
  const float length = glm::length(normal);
  if (!(length > 0.0F)) return slide;
  normal /= length;
  const glm::vec3 other = std::abs(normal.x) < 0.6F ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  const glm::vec3 x = glm::normalize(glm::cross(other, normal));
  const glm::vec3 y = glm::cross(normal, x);
  std::array<glm::vec2, most_neighbours> flat;
  for (std::size_t k = 0; k < size_; ++k) flat[k] = {glm::dot(offsets_[k], x), glm::dot(offsets_[k], y)};
  const glm::vec2 t = flat[i];
  const float smallest = 1e-6F * length;
  float largest = -1.0F;
  for (std::size_t k = 0; k < size_; ++k) {
    const glm::vec2 &b = flat[k], &c = flat[after(k)];
    if (!(cross2(b, c) >= -smallest)) return slide;  // an old face may stand upright
    if (k == i || after(k) == i) continue;
    const glm::vec2 tb = b - t, tc = c - t;
    const float area = cross2(tb, tc);
    if (!(area > smallest)) return slide;
    // The apex, if it lies in this new triangle.
    const float s = cross2(-t, tc) / area, r = cross2(tb, -t) / area;
    if (s < -1e-5F || r < -1e-5F || s + r > 1.0F + 1e-5F) continue;
    largest = std::max(largest, glm::length(target + s * (offsets_[k] - target) + r * (offsets_[after(k)] - target)));
  }
  if (largest < 0.0F) return slide;
  // Crossings of old spokes (origin to ring k) with new diagonals (target to ring j).
  for (std::size_t j = after(after(i)); j != before(i); j = after(j)) {
    const glm::vec2 diagonal = flat[j] - t;
    for (std::size_t k = 0; k < size_; ++k) {
      if (k == i || k == j) continue;
      const float det = cross2(diagonal, flat[k]);
      const float along_new = cross2(-t, flat[k]), along_old = cross2(-t, diagonal);
      // Both in (0, det), whatever its sign.
      if (!(along_new * det > 0.0F && along_old * det > 0.0F && std::abs(along_new) < std::abs(det) &&
            std::abs(along_old) < std::abs(det)))
        continue;
      const glm::vec3 old_point = along_old / det * offsets_[k];
      const glm::vec3 new_point = target + along_new / det * (offsets_[j] - target);
      largest = std::max(largest, glm::distance(old_point, new_point));
    }
  }
  return std::min(slide, largest * round_up + 1e-6F * slide);
}

}  // namespace occlod
