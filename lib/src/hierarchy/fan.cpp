#include "fan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace occlod {
namespace {

// As in collapse_rules.cpp.
constexpr float min_cos_turn = 0.25F;
constexpr float min_sin2_corner = 1e-11F;
constexpr float unbounded = std::numeric_limits<float>::infinity();
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

void Fan::measure_normals() {
  const std::size_t n = columns();
  for (std::size_t i = 0; i < n; ++i) {
    const float x = y_[i] * z_[i + 1] - z_[i] * y_[i + 1];
    const float y = z_[i] * x_[i + 1] - x_[i] * z_[i + 1];
    const float z = x_[i] * y_[i + 1] - y_[i] * x_[i + 1];
    normal_x_[i] = x;
    normal_y_[i] = y;
    normal_z_[i] = z;
    area2_[i] = x * x + y * y + z * z;
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
  const std::size_t n = columns();
  for (std::size_t i = 0; i < n; ++i) {
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
    const std::size_t n = columns();
    std::uint32_t common = 0;
    for (const VertexId w : star.ring())
      for (std::size_t k = 0; k < n; ++k) common += ring_[k] == w ? 1U : 0U;
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
  const std::size_t n = columns();
  for (std::size_t k = 0; k < n; ++k) {
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
  for (std::size_t k = 0; k < n; ++k) fail |= fails[k];
  return fail == 0;
}

// The fan in a frame along its mean normal, turned so that the target is the first corner. Then the apex is the origin,
// new triangles are (0, k, k + 1), and heights are linear over each triangle.
struct Fan::Overlay {
  std::size_t size;
  alignas(16) Row x, y, height;
  alignas(16) Row dx, dy, side;  // the diagonal from corner 0 to k; < 0 where the apex is on its left

  [[nodiscard]] std::size_t columns() const { return (size + 3) & ~std::size_t{3}; }

  void make_diagonals() {
    for (std::size_t k = 0; k < columns(); ++k) {
      dx[k] = x[k] - x[0];
      dy[k] = y[k] - y[0];
      side[k] = y[0] * dx[k] - x[0] * dy[k];
    }
    dx[columns()] = dy[columns()] = 0.0F;
  }

  // Both fans must cover the polygon once. An old face may be perpendicular.
  [[nodiscard]] bool covers_once(float smallest_area) const {
    alignas(16) std::array<std::int32_t, most_neighbours> fails;
    for (std::size_t k = 0; k < columns(); ++k) {
      const float old_area = x[k] * y[k + 1] - y[k] * x[k + 1], new_area = dx[k] * dy[k + 1] - dy[k] * dx[k + 1];
      const std::int32_t is_end = k == 0 || k + 1 >= size ? 1 : 0;
      fails[k] = (old_area >= -smallest_area ? 0 : 1) | ((new_area > smallest_area ? 0 : 1) & ~is_end);
    }
    std::int32_t fail = 0;
    for (std::size_t k = 0; k < columns(); ++k) fail |= fails[k];
    return fail == 0;
  }

  // The new triangle above or below the apex; 0 when rounding leaves none.
  [[nodiscard]] std::size_t home() const {
    std::size_t k = 1;
    while (k + 1 < size && !(side[k] <= 0.0F && side[k + 1] >= 0.0F)) ++k;
    return k + 1 < size ? k : 0;
  }

  [[nodiscard]] float at_apex(std::size_t k) const {
    const float area = dx[k] * dy[k + 1] - dy[k] * dx[k + 1];
    const float rise = side[k + 1] * (height[k] - height[0]) - side[k] * (height[k + 1] - height[0]);
    return std::abs(height[0] + rise / area);
  }

  // The largest distance where old spokes cross new diagonals: those to corners beyond the diagonal do.
  [[nodiscard]] float at_crossings(std::size_t home) const {
    alignas(16) std::array<std::int32_t, most_neighbours> gaps{};  // bits of positive floats compare like them
    for (std::size_t j = 2; j + 1 < size; ++j) {
      const float jx = dx[j], jy = dy[j], rise = height[j] - height[0], along_old = side[j];
      const auto begin = static_cast<std::int32_t>(j <= home ? 1 : j + 1);
      const auto end = static_cast<std::int32_t>(j <= home ? j : size);
      for (std::size_t k = 0; k < columns(); ++k) {
        const float det = jx * y[k] - jy * x[k], along_new = y[0] * x[k] - x[0] * y[k];
        const float gap = std::abs((along_old * height[k] - along_new * rise) / det - height[0]);
        const auto at = static_cast<std::int32_t>(k);
        // Within both lines, but for rounding.
        const bool on_new = std::abs(along_new) <= std::abs(det), on_old = std::abs(along_old) <= std::abs(det);
        const bool crosses = (at >= begin) & (at < end) & on_new & on_old & (gap < unbounded);
        const std::int32_t bits = crosses ? std::bit_cast<std::int32_t>(gap) : 0;
        gaps[k] = bits > gaps[k] ? bits : gaps[k];
      }
    }
    return std::bit_cast<float>(*std::max_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(size)));
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
  float reach2 = 0.0F;
  for (std::size_t k = 0, from = i; k <= padded_; ++k, from = after(from)) {
    overlay.dx[k] = x_[from];
    overlay.dy[k] = y_[from];
    overlay.side[k] = z_[from];
  }
  alignas(16) Row reach;
  for (std::size_t k = 0; k < columns(); ++k) {
    const float x = overlay.dx[k], y = overlay.dy[k], z = overlay.side[k];
    overlay.x[k] = x * frame.x.x + y * frame.x.y + z * frame.x.z;
    overlay.y[k] = x * frame.y.x + y * frame.y.y + z * frame.y.z;
    overlay.height[k] = x * normal.x + y * normal.y + z * normal.z;
    reach[k] = x * x + y * y + z * z;
  }
  overlay.x[columns()] = overlay.x[columns() - size_];
  overlay.y[columns()] = overlay.y[columns() - size_];
  for (std::size_t k = 0; k < size_; ++k) reach2 = std::max(reach2, reach[k]);
  overlay.make_diagonals();
  if (!overlay.covers_once(1e-6F * length)) return slide;
  const std::size_t home = overlay.home();
  if (home == 0) return slide;
  const float largest = std::max(overlay.at_apex(home), overlay.at_crossings(home));
  return std::min(slide, largest * round_up + 5e-7F * std::sqrt(reach2));
}

}  // namespace occlod
