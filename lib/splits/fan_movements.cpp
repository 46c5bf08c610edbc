#include <cassert>
#include <limits>

#include "splits/fan.h"

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splits/fan_movements.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Fans = hn::CappedTag<float, FanMovements::capacity>;
using FanVec = hn::Vec<Fans>;
using FanMask = hn::Mask<Fans>;
using PerFan = FanMovements::PerFan<float>;

constexpr float round_up = 1.0F + 1e-5F;

HWY_INLINE FanVec set(float value) { return hn::Set(Fans(), value); }
HWY_INLINE FanVec load(const PerFan& values, std::size_t i) { return hn::LoadU(Fans(), values.data() + i); }
HWY_INLINE FanVec difference(FanVec a, FanVec b, FanVec c, FanVec d) { return hn::Sub(hn::Mul(a, b), hn::Mul(c, d)); }
HWY_INLINE FanVec dot(FanVec ax, FanVec ay, FanVec az, FanVec bx, FanVec by, FanVec bz) {
  return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}

// Represents fans in frames along their mean normals. Their apices are the origin, new triangles are (0, k, k + 1), and
// heights are linear over each triangle.
class Overlay {
 public:
  HWY_INLINE Overlay(const FanMovements& fans, std::size_t i) : n_(fans.corner_count()) {
    const FanMovements::Corners& corners = fans.corners();
    const FanVec nx = load(corners.normal_x, i), ny = load(corners.normal_y, i), nz = load(corners.normal_z, i);
    length_ = hn::Sqrt(dot(nx, ny, nz, nx, ny, nz));
    project(corners, i, hn::Div(nx, length_), hn::Div(ny, length_), hn::Div(nz, length_));
    make_diagonals();
  }

  // Computes the bound described at ChangeBound in collapse_rules.h.
  HWY_INLINE FanVec bound() const {
    const FanVec slide = hn::Mul(hn::Sqrt(slide2_), set(round_up));
    FanVec home, gap;
    FanMask is_bounded = hn::And(covers_once(), find_home(home, gap));
    is_bounded = hn::And(is_bounded, hn::Gt(length_, hn::Zero(Fans())));
    const FanVec crossings = at_crossings(home);
    gap = hn::IfThenElse(hn::Lt(gap, crossings), crossings, gap);
    const FanVec largest = hn::Add(hn::Mul(gap, set(round_up)), hn::Mul(set(5e-7F), hn::Sqrt(reach2_)));
    return hn::IfThenElse(hn::And(is_bounded, hn::Lt(largest, slide)), largest, slide);
  }

 private:
  [[nodiscard]] std::size_t after(std::size_t k) const { return k + 1 == n_ ? 0 : k + 1; }
  [[nodiscard]] HWY_INLINE FanVec get(const PerFan& row) const { return hn::LoadU(Fans(), row.data()); }
  HWY_INLINE void put(FanVec values, PerFan& row) { hn::StoreU(values, Fans(), row.data()); }

  // Computes two axes that form an orthonormal frame with the normal (Duff et al. 2017).
  HWY_INLINE void project(const FanMovements::Corners& corners, std::size_t i, FanVec nx, FanVec ny, FanVec nz) {
    const FanVec one = set(1.0F), sign = hn::CopySign(one, nz);
    const FanVec a = hn::Div(set(-1.0F), hn::Add(sign, nz)), b = hn::Mul(hn::Mul(nx, ny), a);
    const FanVec xx = hn::Add(one, hn::Mul(hn::Mul(hn::Mul(sign, nx), nx), a)), xy = hn::Mul(sign, b),
                 xz = hn::Neg(hn::Mul(sign, nx));
    const FanVec yy = hn::Add(sign, hn::Mul(hn::Mul(ny, ny), a)), yz = hn::Neg(ny);
    reach2_ = hn::Zero(Fans());
    for (std::size_t k = 0; k < n_; ++k) {
      const FanVec x = load(corners.x[k], i), y = load(corners.y[k], i), z = load(corners.z[k], i);
      put(dot(x, y, z, xx, xy, xz), x_[k]);
      put(dot(x, y, z, b, yy, yz), y_[k]);
      put(dot(x, y, z, nx, ny, nz), height_[k]);
      const FanVec square = dot(x, y, z, x, y, z);
      if (k == 0) slide2_ = square;
      reach2_ = hn::Max(reach2_, square);
    }
  }

  // Computes the diagonals from corner 0 to k; `side` is negative where the apex is on the left of one.
  HWY_INLINE void make_diagonals() {
    const FanVec x0 = get(x_[0]), y0 = get(y_[0]);
    for (std::size_t k = 0; k < n_; ++k) {
      const FanVec dx = hn::Sub(get(x_[k]), x0), dy = hn::Sub(get(y_[k]), y0);
      put(dx, dx_[k]);
      put(dy, dy_[k]);
      put(difference(y0, dx, x0, dy), side_[k]);
    }
  }

  // Returns whether both fans cover the polygon once. An old face may be perpendicular.
  HWY_INLINE FanMask covers_once() const {
    const FanVec smallest = hn::Mul(set(1e-6F), length_), least = hn::Neg(smallest);
    FanMask covers = hn::Ge(length_, hn::Zero(Fans()));
    for (std::size_t k = 0; k < n_; ++k) {
      const std::size_t next = after(k);
      const FanVec old_area = difference(get(x_[k]), get(y_[next]), get(y_[k]), get(x_[next]));
      covers = hn::And(covers, hn::Ge(old_area, least));
      if (k > 0 && next > 0) covers = hn::And(covers, hn::Gt(new_area(k), smallest));
    }
    return covers;
  }

  HWY_INLINE FanVec new_area(std::size_t k) const {
    return difference(get(dx_[k]), get(dy_[k + 1]), get(dy_[k]), get(dx_[k + 1]));
  }

  // Finds the new triangle above or below the apex, and the distance between them. False where rounding leaves none.
  HWY_INLINE FanMask find_home(FanVec& home, FanVec& gap) const {
    const FanVec zero = hn::Zero(Fans()), h0 = get(height_[0]);
    home = gap = zero;
    FanMask found = hn::Gt(zero, zero);
    for (std::size_t k = n_ - 2; k > 0; --k) {
      const FanVec side = get(side_[k]), next_side = get(side_[k + 1]);
      const FanMask is_here = hn::And(hn::Le(side, zero), hn::Ge(next_side, zero));
      const FanVec rise = difference(next_side, hn::Sub(get(height_[k]), h0), side, hn::Sub(get(height_[k + 1]), h0));
      home = hn::IfThenElse(is_here, set(static_cast<float>(k)), home);
      gap = hn::IfThenElse(is_here, hn::Abs(hn::Add(h0, hn::Div(rise, new_area(k)))), gap);
      found = hn::Or(found, is_here);
    }
    return found;
  }

  // Returns the largest height at crossings of old spokes with new diagonals: spokes to corners beyond a diagonal cross
  // it.
  HWY_INLINE FanVec at_crossings(FanVec home) const {
    const FanVec x0 = get(x_[0]), y0 = get(y_[0]), h0 = get(height_[0]);
    FanVec largest = hn::Zero(Fans());
    for (std::size_t j = 2; j + 1 < n_; ++j) {
      const FanVec jx = get(dx_[j]), jy = get(dy_[j]), rise = hn::Sub(get(height_[j]), h0), along_old = get(side_[j]);
      const FanMask is_before_home = hn::Le(set(static_cast<float>(j)), home);
      for (std::size_t k = 1; k < n_; ++k) {
        if (k == j) continue;
        const FanVec x = get(x_[k]), y = get(y_[k]);
        const FanVec det = difference(jx, y, jy, x), along_new = difference(y0, x, x0, y);
        const FanVec above = hn::Div(difference(along_old, get(height_[k]), along_new, rise), det);
        const FanVec gap = hn::Abs(hn::Sub(above, h0));
        // The crossing must lie within both segments, up to rounding.
        const FanVec reach = hn::Abs(det);
        const FanMask crosses = hn::And(hn::Le(hn::Abs(along_new), reach), hn::Le(hn::Abs(along_old), reach));
        const FanMask is_beyond = k < j ? is_before_home : hn::Not(is_before_home);
        const FanMask is_finite = hn::Lt(gap, set(unbounded));
        const FanMask counts = hn::And(hn::And(crosses, is_beyond), hn::And(is_finite, hn::Gt(gap, largest)));
        largest = hn::IfThenElse(counts, gap, largest);
      }
    }
    return largest;
  }

  static constexpr float unbounded = std::numeric_limits<float>::infinity();
  using Row = std::array<PerFan, Fan::max_neighbours>;

  std::size_t n_;
  FanVec length_;           // length of the sum of normals
  FanVec slide2_, reach2_;  // squared distances of corner 0 and of the farthest corner
  Row x_, y_, height_, dx_, dy_, side_;
};

void bound_movements(const FanMovements& fans, PerFan& bounds) {
  for (std::size_t i = 0; i < fans.size(); i += hn::Lanes(Fans()))
    hn::StoreU(Overlay(fans, i).bound(), Fans(), bounds.data() + i);
}

}  // namespace
}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {
namespace {

HWY_EXPORT(bound_movements);

}  // namespace

void FanMovements::add(const Fan& fan, std::size_t i) {
  assert(size_ < capacity && (size_ == 0 || fan.size() == corner_count_));
  corner_count_ = fan.size();
  for (std::size_t k = 0, from = i; k < corner_count_; ++k) {
    const glm::vec3 corner = fan.offset(from);
    corners_.x[k][size_] = corner.x;
    corners_.y[k][size_] = corner.y;
    corners_.z[k][size_] = corner.z;
    if (++from == corner_count_) from = 0;
  }
  const glm::vec3 normal = fan.normal_sum();
  corners_.normal_x[size_] = normal.x;
  corners_.normal_y[size_] = normal.y;
  corners_.normal_z[size_] = normal.z;
  ++size_;
}

FanMovements::PerFan<float> FanMovements::bounds() const {
  PerFan<float> result;
  HWY_DYNAMIC_DISPATCH(bound_movements)(*this, result);
  return result;
}

}  // namespace occlod
#endif  // HWY_ONCE
