#include "splits/fan.h"

#include <algorithm>
#include <cmath>

namespace occlod {
namespace {

// Same value as in collapse_rules.cpp.
constexpr float min_cos_turn = 0.25F;
constexpr float min_sin2_corner = 1e-11F;

// As many zeros as a ring can have vertices, then ones in every bit.
constexpr auto behind_ring = [] {
  std::array<VertexId, 2 * Fan::max_neighbours> masks{};
  for (std::size_t i = Fan::max_neighbours; i < masks.size(); ++i) masks[i] = no_id;
  return masks;
}();
static_assert(no_id == ~VertexId{0});

}  // namespace

bool Fan::gather(const StarMesh& mesh, VertexId v) {
  const Star star = mesh.star(v);
  vertex_ = v;
  size_ = star.size();
  if (!star.is_ring() || size_ > max_neighbours) return false;
  padded_ = (size_ + 7) & ~std::size_t{7};
  const auto ring = star.ring();
  // Whole vectors of the star are read, and what lies behind the ring is masked: the length of a loop that changes from
  // star to star cannot be predicted. Behind the ring lie the numbers of the collapses that made its faces, as many
  // again, and no star has room for less than 8.
  const VertexId* const ids = ring.data();
  const VertexId* const beyond = behind_ring.data() + (max_neighbours - size_);
  const VertexId first = ids[0];
  for (std::size_t i = 0; i < columns(); ++i) {
    ring_[i] = ids[i] | beyond[i];
    around_[i] = (ids[i] & ~beyond[i]) | (first & beyond[i]);
  }
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
    const float inverse = 1.0F / twice_area;  // normals have unit length, weighted by area
    const float x = normal_x_[i], y = normal_y_[i], z = normal_z_[i];
    q.xx += x * x * inverse, q.xy += x * y * inverse, q.xz += x * z * inverse;
    q.yy += y * y * inverse, q.yz += y * z * inverse, q.zz += z * z * inverse;
    q.weight += twice_area;
  }
  return q;
}

glm::vec3 Fan::normal_sum() const {
  glm::vec3 sum(0.0F);
  for (std::size_t k = 0; k < size_; ++k) sum += glm::vec3(normal_x_[k], normal_y_[k], normal_z_[k]);
  return sum;
}

std::span<float> Fan::costs(const VertexQuadric& quadric) {
  const VertexQuadric q = quadric;  // a copy cannot alias the rows
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

// The vertex is inside the surface, so its link is the ring and only the plain link condition is left: the ring must
// meet the link of ring_[i] in exactly the two corners beside it, and in no edge.
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
  alignas(16) std::array<std::int32_t, max_neighbours> fails;
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
  fails[i] = fails[before(i)] = 0;  // these two faces vanish
  std::int32_t fail = 0;
  for (std::size_t k = 0; k < n; ++k) fail |= fails[k];
  return fail == 0;
}

}  // namespace occlod
