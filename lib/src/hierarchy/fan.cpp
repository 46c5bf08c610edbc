#include "fan.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace occlod {
namespace {

// As in collapse_rules.cpp.
constexpr float min_cos_turn = 0.25F;
constexpr float min_sin2_corner = 1e-11F;
constexpr float round_up = 1.0F + 1e-5F;

// Two axes that with `normal` (unit) make an orthonormal frame (Duff et al. 2017).
struct Frame {
  glm::vec3 x, y;
  explicit Frame(const glm::vec3& normal) {
    const float sign = std::copysign(1.0F, normal.z);
    const float a = -1.0F / (sign + normal.z);
    const float b = normal.x * normal.y * a;
    x = {1.0F + sign * normal.x * normal.x * a, sign * b, -sign * normal.x};
    y = {b, sign + normal.y * normal.y * a, -normal.y};
  }
};

}  // namespace

bool Fan::gather(const StarMesh& mesh, VertexId v) {
  const Star star = mesh.star(v);
  vertex_ = v;
  size_ = star.size();
  if (!star.is_ring() || size_ > most_neighbours) return false;
  padded_ = (size_ + 3) & ~std::size_t{3};
  const auto ring = star.ring();
  for (std::size_t i = 0; i < size_; ++i) ring_[i] = ring[i];
  for (std::size_t i = size_; i < padded_; ++i) ring_[i] = no_id;
  return true;
}

void Fan::measure_offsets(std::span<const glm::vec3> positions) {
  const glm::vec3 origin = positions[vertex_];
  for (std::size_t i = 0; i < size_; ++i) {
    const glm::vec3& p = positions[ring_[i]];
    x_[i] = p.x - origin.x;
    y_[i] = p.y - origin.y;
    z_[i] = p.z - origin.z;
  }
  for (std::size_t i = size_; i <= padded_; ++i) {
    x_[i] = x_[0];
    y_[i] = y_[0];
    z_[i] = z_[0];
  }
}

void Fan::measure(std::span<const glm::vec3> positions) {
  measure_offsets(positions);
  for (std::size_t i = 0; i < padded_; ++i) {
    normal_x_[i] = y_[i] * z_[i + 1] - z_[i] * y_[i + 1];
    normal_y_[i] = z_[i] * x_[i + 1] - x_[i] * z_[i + 1];
    normal_z_[i] = x_[i] * y_[i + 1] - y_[i] * x_[i + 1];
    area2_[i] = normal_x_[i] * normal_x_[i] + normal_y_[i] * normal_y_[i] + normal_z_[i] * normal_z_[i];
  }
}

VertexQuadric Fan::quadric() const {
  VertexQuadric q;
  for (std::size_t i = 0; i < size_; ++i) {
    const float twice_area = std::sqrt(area2_[i]);
    if (!(twice_area > 0.0F)) continue;
    const float inverse = 1.0F / twice_area;  // unit normals, weighted by area
    const float x = normal_x_[i], y = normal_y_[i], z = normal_z_[i];
    q.xx += x * x * inverse, q.xy += x * y * inverse, q.xz += x * z * inverse;
    q.yy += y * y * inverse, q.yz += y * z * inverse, q.zz += z * z * inverse;
    q.weight += twice_area;
  }
  return q;
}

std::span<float> Fan::costs(const VertexQuadric& quadric) {
  const VertexQuadric q = quadric;  // no alias of the rows
  const float inverse = q.inverse_weight(), order = q.order();
  const float bx = 2.0F * q.b.x, by = 2.0F * q.b.y, bz = 2.0F * q.b.z;
  for (std::size_t i = 0; i < padded_; ++i) {
    const float x = x_[i], y = y_[i], z = z_[i];
    const float sum = x * (q.xx * x + bx + 2.0F * (q.xy * y + q.xz * z)) + y * (q.yy * y + by + 2.0F * q.yz * z) +
                      z * (q.zz * z + bz) + q.c;
    const float mean = (sum > 0.0F ? sum : 0.0F) * inverse;
    costs_[i] = order * (mean + VertexQuadric::edge_length_weight * (x * x + y * y + z * z));
  }
  return {costs_.data(), size_};
}

// The vertex is inside the surface, so its link is the ring, and only the plain link condition is left: the ring meets
// the link of ring_[i] in the two corners beside it, and in no edge.
bool Fan::keeps_topology(const StarMesh& mesh, std::size_t i) const {
  const VertexId u = ring_[i];
  const Star star = mesh.star(u);
  if (star.is_ring()) {
    std::uint32_t common = 0;
    for (const VertexId w : star.ring())
      for (std::size_t k = 0; k < padded_; ++k) common += ring_[k] == w ? 1U : 0U;
    return common == 2 && (size_ > 3 || star.size() > 3);  // a tetrahedron would fold flat
  }
  const VertexId left = ring_[before(i)], right = ring_[after(i)];
  const auto is_elsewhere_in_ring = [&](VertexId w) {
    const auto around = ring();
    return w != left && w != right && std::find(around.begin(), around.end(), w) != around.end();
  };
  for (const StarFace f : star) {
    if (contains(f, vertex_)) continue;
    if (is_elsewhere_in_ring(f.next) || is_elsewhere_in_ring(f.last)) return false;
    if (size_ == 3 && contains(f, left) && contains(f, right)) return false;
  }
  return true;
}

bool Fan::keeps_orientation(std::size_t i) const {
  const float tx = x_[i], ty = y_[i], tz = z_[i];
  alignas(16) std::array<std::int32_t, most_neighbours> fails;
  for (std::size_t k = 0; k < padded_; ++k) {
    const float ax = x_[k] - tx, ay = y_[k] - ty, az = z_[k] - tz;
    const float bx = x_[k + 1] - tx, by = y_[k + 1] - ty, bz = z_[k + 1] - tz;
    const float mx = ay * bz - az * by, my = az * bx - ax * bz, mz = ax * by - ay * bx;
    const float moved2 = mx * mx + my * my + mz * mz;
    const float turn = normal_x_[k] * mx + normal_y_[k] * my + normal_z_[k] * mz;
    const float sides = (ax * ax + ay * ay + az * az) * (bx * bx + by * by + bz * bz);
    const std::int32_t turns = turn > 0.0F ? 0 : 1;
    const std::int32_t far = turn * turn >= min_cos_turn * min_cos_turn * area2_[k] * moved2 ? 0 : 1;
    const std::int32_t flat = moved2 > min_sin2_corner * sides ? 0 : 1;
    const std::int32_t counts = area2_[k] == 0.0F ? 0 : 1;
    fails[k] = (turns | far | flat) & counts;
  }
  fails[i] = fails[before(i)] = 0;  // these end
  std::int32_t fail = 0;
  for (std::size_t k = 0; k < padded_; ++k) fail |= fails[k];
  return fail == 0;
}

// The fan in a frame along its mean normal, turned so that the target is the first corner. Then the apex is the origin,
// new triangles are (0, k, k + 1), and heights are linear over each triangle.
struct Fan::Overlay {
  std::size_t size;
  alignas(16) Row x, y, height;
  float smallest;        // of areas that count
  std::size_t home = 0;  // the new triangle above or below the apex

  // Both fans must cover the polygon once. An old face may stand upright.
  [[nodiscard]] bool covers_once() const {
    float least_old = 0.0F, least_new = 2.0F * smallest;
    for (std::size_t k = 0; k < size; ++k) least_old = std::min(least_old, x[k] * y[k + 1] - y[k] * x[k + 1]);
    for (std::size_t k = 1; k + 1 < size; ++k)
      least_new = std::min(least_new, (x[k] - x[0]) * (y[k + 1] - y[0]) - (y[k] - y[0]) * (x[k + 1] - x[0]));
    return least_old >= -smallest && least_new > smallest;
  }

  // The distance of the apex from the new fan; negative when it is above none of its triangles.
  float at_apex() {
    for (std::size_t k = 1; k + 1 < size; ++k) {
      const float bx = x[k] - x[0], by = y[k] - y[0], cx = x[k + 1] - x[0], cy = y[k + 1] - y[0];
      const float s = y[0] * cx - x[0] * cy, r = by * x[0] - bx * y[0];
      const float area = bx * cy - by * cx;
      if (s < -1e-5F * area || r < -1e-5F * area || s + r > (1.0F + 1e-5F) * area) continue;
      home = k;
      return std::abs(height[0] + (s * (height[k] - height[0]) + r * (height[k + 1] - height[0])) / area);
    }
    return -1.0F;
  }

  // The largest distance where old spokes cross new diagonals. Those to corners beyond the diagonal do.
  [[nodiscard]] float at_crossings() const {
    float largest = 0.0F;
    for (std::size_t j = 2; j + 1 < size; ++j) {
      const float dx = x[j] - x[0], dy = y[j] - y[0], rise = height[j] - height[0];
      const float along_old = y[0] * dx - x[0] * dy;
      const std::size_t begin = j <= home ? 1 : j + 1, end = j <= home ? j : size;
      for (std::size_t k = begin; k < end; ++k) {
        const float det = dx * y[k] - dy * x[k], along_new = y[0] * x[k] - x[0] * y[k];
        const float gap = along_old * height[k] - along_new * rise - det * height[0];
        // Within both lines, but for rounding.
        if (det != 0.0F && std::abs(along_new) <= std::abs(det) && std::abs(along_old) <= std::abs(det))
          largest = std::max(largest, std::abs(gap / det));
      }
    }
    return largest;
  }
};

// See change_bound.h.
float Fan::change_bound(std::size_t i) const {
  const float slide = glm::length(offset(i)) * round_up;
  glm::vec3 normal(0.0F);
  for (std::size_t k = 0; k < size_; ++k) normal += glm::vec3(normal_x_[k], normal_y_[k], normal_z_[k]);
  const float length = glm::length(normal);
  if (!(length > 0.0F)) return slide;
  normal /= length;
  const Frame frame(normal);
  Overlay overlay;
  overlay.size = size_;
  overlay.smallest = 1e-6F * length;
  float reach2 = 0.0F;
  for (std::size_t k = 0, from = i; k <= size_; ++k, from = after(from)) {
    const glm::vec3 corner = offset(from);
    overlay.x[k] = glm::dot(corner, frame.x);
    overlay.y[k] = glm::dot(corner, frame.y);
    overlay.height[k] = glm::dot(corner, normal);
    reach2 = std::max(reach2, glm::dot(corner, corner));
  }
  if (!overlay.covers_once()) return slide;
  const float at_apex = overlay.at_apex();
  if (at_apex < 0.0F) return slide;
  return std::min(slide, std::max(at_apex, overlay.at_crossings()) * round_up + 5e-7F * std::sqrt(reach2));
}

}  // namespace occlod
