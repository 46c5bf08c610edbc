#include "splits/refit_points.h"

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splits/refit_points.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Points = hn::CappedTag<float, 16>;
using PointVec = hn::Vec<Points>;
using PointMask = hn::Mask<Points>;

HWY_INLINE PointVec dot(PointVec x, PointVec y, PointVec z, const glm::vec3& v) {
  const PointVec to_x = hn::Mul(x, hn::Set(Points(), v.x)), to_y = hn::Mul(y, hn::Set(Points(), v.y));
  return hn::Add(hn::Add(to_x, to_y), hn::Mul(z, hn::Set(Points(), v.z)));
}

// Sets the faces of the first `count` points, and perhaps of some beyond them.
void find_faces(std::span<const FacePlane> faces, std::size_t count, RefitPoints::Rows& rows) {
  const Points d;
  const PointVec zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto load = [&](const RefitPoints::Row& row) HWY_ATTR { return hn::Load(d, row.data() + i); };
    const PointVec x = load(rows.x), y = load(rows.y), z = load(rows.z), least = load(rows.least);
    const PointVec normal_x = load(rows.normal_x), normal_y = load(rows.normal_y), normal_z = load(rows.normal_z);
    PointVec face = hn::Set(d, -1.0F), weight_y = zero, weight_z = zero, height = zero;
    PointVec distance = hn::Set(d, std::numeric_limits<float>::infinity());
    for (std::size_t k = 0; k < faces.size(); ++k) {
      const FacePlane& plane = faces[k];
      const PointVec here_y = hn::Add(dot(x, y, z, plane.along_y), hn::Set(d, plane.corner_y));
      const PointVec here_z = hn::Add(dot(x, y, z, plane.along_z), hn::Set(d, plane.corner_z));
      const PointVec above = dot(x, y, z, plane.normal), off = hn::Abs(above);
      const PointMask is_inside =
          hn::And(hn::And(hn::Ge(here_y, zero), hn::Ge(here_z, zero)), hn::Le(hn::Add(here_y, here_z), one));
      const PointMask is_alike = hn::Gt(dot(normal_x, normal_y, normal_z, plane.normal), least);
      const PointMask is_best = hn::And(hn::And(is_inside, is_alike), hn::Lt(off, distance));
      distance = hn::IfThenElse(is_best, off, distance);
      face = hn::IfThenElse(is_best, hn::Set(d, static_cast<float>(k)), face);
      weight_y = hn::IfThenElse(is_best, here_y, weight_y);
      weight_z = hn::IfThenElse(is_best, here_z, weight_z);
      height = hn::IfThenElse(is_best, above, height);
    }
    hn::Store(face, d, rows.face.data() + i);
    hn::Store(weight_y, d, rows.weight_y.data() + i);
    hn::Store(weight_z, d, rows.weight_z.data() + i);
    hn::Store(height, d, rows.height.data() + i);
  }
}

}  // namespace
}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {
namespace {

HWY_EXPORT(find_faces);

}  // namespace

void RefitPoints::settle(std::span<const FacePlane> faces, std::span<FaceSums> sums) {
  HWY_DYNAMIC_DISPATCH(find_faces)(faces, size_, rows_);
  for (std::size_t i = 0; i < size_; ++i) {
    if (rows_.face[i] < 0.0F) continue;
    FaceSums& sum = sums[static_cast<std::size_t>(rows_.face[i])];
    const double y = rows_.weight_y[i], z = rows_.weight_z[i], x = 1.0 - y - z, height = rows_.height[i];
    const double share = rows_.share[i], to_x = share * x, to_y = share * y, to_z = share * z;
    sum.squares[0] += to_x * x, sum.squares[1] += to_x * y, sum.squares[2] += to_x * z;
    sum.squares[3] += to_y * y, sum.squares[4] += to_y * z, sum.squares[5] += to_z * z;
    sum.heights[0] += to_x * height, sum.heights[1] += to_y * height, sum.heights[2] += to_z * height;
  }
  size_ = 0;
}

}  // namespace occlod
#endif  // HWY_ONCE
