#include <cassert>

#include "splits/star_patch.h"

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splits/fan_patches.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Fans = hn::CappedTag<float, FanPatches::capacity>;
using FanVec = hn::Vec<Fans>;
using FanMask = hn::Mask<Fans>;
using PerFan = FanPatchBounds::PerFan;

HWY_INLINE FanVec set(float value) { return hn::Set(Fans(), value); }
HWY_INLINE FanVec load(const PerFan& values, std::size_t i) { return hn::LoadU(Fans(), values.data() + i); }
HWY_INLINE void store(FanVec values, PerFan& out, std::size_t i) { hn::StoreU(values, Fans(), out.data() + i); }

struct Vectors {
  FanVec x, y, z;
};
HWY_INLINE Vectors operator-(const Vectors& a, const Vectors& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE FanVec dot(const Vectors& a, const Vectors& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE FanVec difference(FanVec a, FanVec b, FanVec c, FanVec d) { return hn::Sub(hn::Mul(a, b), hn::Mul(c, d)); }
HWY_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
  return {difference(a.y, b.z, b.y, a.z), difference(a.z, b.x, b.z, a.x), difference(a.x, b.y, b.x, a.y)};
}
// Match std::min and std::max, including zeros of either sign.
HWY_INLINE FanVec min(FanVec a, FanVec b) { return hn::IfThenElse(hn::Lt(b, a), b, a); }
HWY_INLINE FanVec max(FanVec a, FanVec b) { return hn::IfThenElse(hn::Lt(a, b), b, a); }

// Bounds one fan per SIMD lane.
class Bounder {
 public:
  HWY_INLINE Bounder(const FanPatches& fans, std::size_t i)
      : corners_(fans.corners()),
        n_(fans.corner_count()),
        i_(i),
        vertex_{load(corners_.vertex_x, i), load(corners_.vertex_y, i), load(corners_.vertex_z, i)},
        is_bounded_(hn::Eq(hn::Zero(Fans()), hn::Zero(Fans()))) {}

  HWY_INLINE void bound(FanPatchBounds& results) {
    bound_corners(results);
    bound_normals(results);
    store(hn::IfThenElseZero(is_bounded_, set(1.0F)), results.is_bounded, i_);
  }

 private:
  HWY_INLINE Vectors corner(std::size_t k) const {
    return {load(corners_.x[k], i_), load(corners_.y[k], i_), load(corners_.z[k], i_)};
  }
  [[nodiscard]] std::size_t after(std::size_t k) const { return k + 1 == n_ ? 0 : k + 1; }

  HWY_INLINE void bound_corners(FanPatchBounds& results) {
    Vectors low = vertex_, high = vertex_;
    for (std::size_t k = 0; k < n_; ++k) {
      const Vectors p = corner(k);
      low = {min(low.x, p.x), min(low.y, p.y), min(low.z, p.z)};
      high = {max(high.x, p.x), max(high.y, p.y), max(high.z, p.z)};
    }
    store(low.x, results.min_x, i_);
    store(low.y, results.min_y, i_);
    store(low.z, results.min_z, i_);
    store(high.x, results.max_x, i_);
    store(high.y, results.max_y, i_);
    store(high.z, results.max_z, i_);
  }

  HWY_INLINE void bound_normals(FanPatchBounds& results) {
    const Vectors parent = {load(corners_.parent_x, i_), load(corners_.parent_y, i_), load(corners_.parent_z, i_)};
    const FanVec parent_place = load(corners_.parent_place, i_);
    const FanVec zero = hn::Zero(Fans());
    sum_ = {zero, zero, zero};
    for (std::size_t k = 0; k < n_; ++k) {
      const Vectors a = corner(k), b = corner(after(k));
      add_normal(2 * k, vertex_, a, b, hn::Eq(zero, zero));
      const FanMask touches = hn::Or(hn::Eq(parent_place, set(static_cast<float>(k))),
                                     hn::Eq(parent_place, set(static_cast<float>(after(k)))));
      add_normal(2 * k + 1, parent, a, b, hn::Not(touches));
    }
    const FanVec length2 = dot(sum_, sum_), length = hn::Sqrt(length2);
    const FanMask is_direction = hn::Gt(length2, set(1e-12F));
    const Vectors axis = {hn::IfThenElse(is_direction, hn::Div(sum_.x, length), zero),
                          hn::IfThenElse(is_direction, hn::Div(sum_.y, length), zero),
                          hn::IfThenElse(is_direction, hn::Div(sum_.z, length), set(1.0F))};
    FanVec cos_angle = set(1.0F), sin2 = zero;
    for (std::size_t k = 0; k < 2 * n_; ++k) {
      const Vectors normal = {hn::LoadU(Fans(), normal_x_[k].data()), hn::LoadU(Fans(), normal_y_[k].data()),
                              hn::LoadU(Fans(), normal_z_[k].data())};
      const FanMask is_there = hn::Ne(dot(normal, normal), zero);
      const FanVec cos = dot(axis, normal);
      cos_angle = hn::IfThenElse(hn::And(is_there, hn::Lt(cos, cos_angle)), cos, cos_angle);
      const Vectors sin = cross(axis, normal);
      sin2 = max(sin2, dot(sin, sin));
    }
    const FanVec slack = set(normal_slack);
    cos_angle = hn::IfThenElse(hn::Gt(cos_angle, slack), hn::Sub(cos_angle, slack), set(-1.0F));
    store(axis.x, results.axis_x, i_);
    store(axis.y, results.axis_y, i_);
    store(axis.z, results.axis_z, i_);
    store(cos_angle, results.cos_angle, i_);
    store(hn::Add(hn::Sqrt(sin2), slack), results.sin_angle, i_);
  }

  // Adds the normal of the triangle from apex to two corners; zero where it does not exist.
  HWY_INLINE void add_normal(std::size_t k, const Vectors& apex, const Vectors& corner, const Vectors& next,
                             FanMask is_there) {
    const Vectors a = corner - apex, b = next - apex;
    const Vectors normal = cross(a, b);
    const FanVec length2 = dot(normal, normal);
    const FanMask is_usual = hn::And(hn::Gt(length2, hn::Mul(hn::Mul(set(min_sin2), dot(a, a)), dot(b, b))),
                                     hn::And(hn::Gt(length2, set(1e-30F)), hn::Lt(length2, set(1e30F))));
    require(hn::Or(is_usual, hn::Not(is_there)));
    const FanVec scale = hn::Div(set(1.0F), hn::Sqrt(length2));
    put(is_there, hn::Mul(normal.x, scale), sum_.x, normal_x_[k]);
    put(is_there, hn::Mul(normal.y, scale), sum_.y, normal_y_[k]);
    put(is_there, hn::Mul(normal.z, scale), sum_.z, normal_z_[k]);
  }
  static HWY_INLINE void put(FanMask is_there, FanVec value, FanVec& sum, PerFan& row) {
    sum = hn::IfThenElse(is_there, hn::Add(sum, value), sum);
    hn::StoreU(hn::IfThenElseZero(is_there, value), Fans(), row.data());
  }

  HWY_INLINE void require(FanMask mask) { is_bounded_ = hn::And(is_bounded_, mask); }

  const FanPatches::Corners& corners_;
  std::size_t n_, i_;
  Vectors vertex_, sum_;
  FanMask is_bounded_;
  std::array<PerFan, 2 * FanPatches::max_corners> normal_x_, normal_y_, normal_z_;
};

void bound_fans(const FanPatches& fans, FanPatchBounds& results) {
  for (std::size_t i = 0; i < fans.size(); i += hn::Lanes(Fans())) Bounder(fans, i).bound(results);
}

}  // namespace
}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {
namespace {

HWY_EXPORT(bound_fans);

}  // namespace

void FanPatches::add(VertexId v, std::span<const VertexId> ring, VertexId parent,
                     std::span<const glm::vec3> positions) {
  assert(size_ < capacity && ring.size() <= max_corners && (size_ == 0 || ring.size() == corner_count_));
  const std::size_t i = size_++;
  corner_count_ = ring.size();
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const glm::vec3& p = positions[ring[k]];
    corners_.x[k][i] = p.x;
    corners_.y[k][i] = p.y;
    corners_.z[k][i] = p.z;
    if (ring[k] == parent) corners_.parent_place[i] = static_cast<float>(k);
  }
  const glm::vec3 &apex = positions[v], &removed_apex = positions[parent];
  corners_.vertex_x[i] = apex.x;
  corners_.vertex_y[i] = apex.y;
  corners_.vertex_z[i] = apex.z;
  corners_.parent_x[i] = removed_apex.x;
  corners_.parent_y[i] = removed_apex.y;
  corners_.parent_z[i] = removed_apex.z;
}

FanPatchBounds FanPatches::bounds() const {
  FanPatchBounds result;
  HWY_DYNAMIC_DISPATCH(bound_fans)(*this, result);
  return result;
}

BoundedPatch FanPatchBounds::operator[](std::size_t i) const noexcept {
  return {{{axis_x[i], axis_y[i], axis_z[i]}, cos_angle[i], sin_angle[i], true},
          {{min_x[i], min_y[i], min_z[i]}, {max_x[i], max_y[i], max_z[i]}}};
}

}  // namespace occlod
#endif  // HWY_ONCE
