#include "splits/star_points.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splits/star_points.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

// Points to corners, one array per coordinate.
#ifndef OCCLOD_SPLITS_CORNER_ROWS
#define OCCLOD_SPLITS_CORNER_ROWS
namespace occlod {
struct CornerRows {
  const float *x, *y, *z;
  std::size_t size;
};
}  // namespace occlod
#endif

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Points = hn::CappedTag<float, 16>;
using PointVec = hn::Vec<Points>;

struct Vectors {
  PointVec x, y, z;
};
HWY_INLINE Vectors set(const glm::vec3& v) {
  return {hn::Set(Points(), v.x), hn::Set(Points(), v.y), hn::Set(Points(), v.z)};
}
HWY_INLINE PointVec dot(const Vectors& a, const Vectors& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

// Leaves the radii squared.
void measure_in(const CornerRows& corners, const glm::vec3& center, const glm::vec3& axis, PointExtents& result) {
  const Points d;
  const Vectors middle = set(center), direction = set(axis);
  const Vectors any = set({corners.x[0], corners.y[0], corners.z[0]});
  PointVec radius2 = hn::Zero(d), beside2 = radius2;
  PointVec t_min = hn::Set(d, result.t_min), t_max = hn::Set(d, result.t_max);
  for (std::size_t i = 0; i < corners.size; i += hn::Lanes(d)) {
    const auto is_corner = hn::FirstN(d, corners.size - i);
    const auto offset_of = [&](const float* row, PointVec first, PointVec from) HWY_ATTR {
      return hn::Sub(hn::IfThenElse(is_corner, hn::LoadU(d, row + i), first), from);
    };
    const Vectors offset = {offset_of(corners.x, any.x, middle.x), offset_of(corners.y, any.y, middle.y),
                            offset_of(corners.z, any.z, middle.z)};
    const PointVec t = dot(offset, direction);
    const Vectors beside = {hn::Sub(offset.x, hn::Mul(t, direction.x)), hn::Sub(offset.y, hn::Mul(t, direction.y)),
                            hn::Sub(offset.z, hn::Mul(t, direction.z))};
    radius2 = hn::Max(radius2, dot(offset, offset));
    beside2 = hn::Max(beside2, dot(beside, beside));
    t_min = hn::Min(t_min, t);
    t_max = hn::Max(t_max, t);
  }
  result = {hn::GetLane(hn::MaxOfLanes(d, radius2)), hn::GetLane(hn::MaxOfLanes(d, beside2)),
            hn::GetLane(hn::MinOfLanes(d, t_min)), hn::GetLane(hn::MaxOfLanes(d, t_max))};
}

}  // namespace
}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {
namespace {

HWY_EXPORT(measure_in);

// Measures extents whose squares leave the range of floats.
PointExtents measure_in_double(const CornerRows& corners, const glm::vec3& center, const glm::vec3& axis) {
  PointExtents result;
  for (std::size_t i = 0; i < corners.size; ++i) {
    const glm::dvec3 offset = glm::dvec3(corners.x[i], corners.y[i], corners.z[i]) - glm::dvec3(center);
    const double t = glm::dot(offset, glm::dvec3(axis));
    const auto raise = [](float& most, double value) { most = std::max(most, static_cast<float>(value)); };
    raise(result.radius, glm::length(offset));
    raise(result.cylinder_radius, glm::length(offset - t * glm::dvec3(axis)));
    raise(result.t_max, t);
    result.t_min = std::min(result.t_min, static_cast<float>(t));
  }
  return result;
}

}  // namespace

void StarPoints::add(const SplitStar& star, std::span<const glm::vec3> positions) {
  const std::size_t most =
      1 + (star.is_fan() ? star.ring().size() : 3 * (std::size_t{star.inserted_count()} + star.removed_count()));
  if (const std::size_t needed = size_ + most + padding; needed > x_.size())
    for (std::vector<float>* row : {&x_, &y_, &z_}) row->resize(2 * needed);
  put(positions[star.vertex()]);
  if (star.is_fan())
    for (const VertexId v : star.ring()) put(positions[v]);
  else
    star.for_each_face([&](const Triangle& t) {
      for (int k = 0; k < 3; ++k) put(positions[t[k]]);
    });
  starts_.push_back(size_);
}

PointExtents StarPoints::extents(std::size_t first, std::size_t end, const glm::vec3& center,
                                 const glm::vec3& axis) const {
  const std::size_t start = starts_[first];
  const CornerRows corners{x_.data() + start, y_.data() + start, z_.data() + start, starts_[end] - start};
  PointExtents result;
  HWY_DYNAMIC_DISPATCH(measure_in)(corners, center, axis, result);
  if (!(result.radius > 1e-30F && result.radius < 1e30F)) return measure_in_double(corners, center, axis);
  result.radius = std::sqrt(result.radius);
  result.cylinder_radius = std::sqrt(result.cylinder_radius);
  return result;
}

}  // namespace occlod
#endif  // HWY_ONCE
