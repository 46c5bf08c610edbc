#include "priority/fan_visibility.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "priority/fan_visibility.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, FanCorners::most_lanes>;
using Vec = hn::Vec<Floats>;

struct Vec3 {
  Vec x, y, z;
};

HWY_INLINE Vec3 constant(const glm::vec3& v) {
  const Floats d;
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}
HWY_INLINE Vec3 load(const FanCorners& corners, std::size_t place) {
  const Floats d;
  return {hn::LoadU(d, corners.x.data() + place), hn::LoadU(d, corners.y.data() + place),
          hn::LoadU(d, corners.z.data() + place)};
}
HWY_INLINE Vec3 subtract(const Vec3& a, const Vec3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vec dot(const Vec3& a, const Vec3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vec difference(Vec a, Vec b, Vec c, Vec d) { return hn::Sub(hn::Mul(a, b), hn::Mul(c, d)); }
HWY_INLINE Vec3 cross(const Vec3& a, const Vec3& b) {
  return {difference(a.y, b.z, b.y, a.z), difference(a.z, b.x, b.z, a.x), difference(a.x, b.y, b.x, a.y)};
}

Sphere sphere_of(const FanCorners& corners) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  Vec3 low = constant(corners.vertex), high = low;
  for (std::size_t i = 0; i < corners.ring_size; i += lanes) {
    const Vec3 p = load(corners, i);
    low = {hn::Min(low.x, p.x), hn::Min(low.y, p.y), hn::Min(low.z, p.z)};
    high = {hn::Max(high.x, p.x), hn::Max(high.y, p.y), hn::Max(high.z, p.z)};
  }
  const auto least = [&](Vec v) HWY_ATTR { return hn::GetLane(hn::MinOfLanes(d, v)); };
  const auto most = [&](Vec v) HWY_ATTR { return hn::GetLane(hn::MaxOfLanes(d, v)); };
  Sphere sphere;
  sphere.center = 0.5F * glm::vec3(least(low.x), least(low.y), least(low.z)) +
                  0.5F * glm::vec3(most(high.x), most(high.y), most(high.z));
  const Vec3 center = constant(sphere.center);
  Vec3 off = subtract(center, constant(corners.vertex));
  Vec farthest = dot(off, off);
  for (std::size_t i = 0; i < corners.ring_size; i += lanes) {
    off = subtract(center, load(corners, i));
    farthest = hn::Max(farthest, dot(off, off));
  }
  sphere.radius = std::sqrt(most(farthest));
  return sphere;
}

// Faces from `apex` to neighbours in the ring, of which `is_face(lane)` are there; adds them up in their order.
struct FaceSums {
  HWY_INLINE FaceSums(const FanCorners& fan, const glm::vec3& eye_at, bool both_sides)
      : corners(fan), eye(eye_at), two_sided(both_sides) {}

  template <typename IsFace>
  HWY_INLINE void add(const glm::vec3& apex, const IsFace& is_face) {
    const Floats d;
    const std::size_t lanes = hn::Lanes(d);
    const glm::vec3 to_eye = eye - apex;
    const Vec distance = hn::Set(d, glm::length(to_eye));
    const Vec3 a = constant(apex), e = constant(to_eye);
    HWY_ALIGN std::array<float, FanCorners::capacity> wholes, facings;
    for (std::size_t i = 0; i < corners.inserted; i += lanes) {
      const Vec3 normal = cross(subtract(load(corners, i), a), subtract(load(corners, i + 1), a));
      const Vec facing = dot(normal, e);
      const auto lane = hn::Add(hn::Iota(d, 0.0F), hn::Set(d, static_cast<float>(i)));
      auto seen = hn::And(is_face(lane), hn::Lt(lane, hn::Set(d, static_cast<float>(corners.inserted))));
      if (!two_sided) seen = hn::And(seen, hn::Gt(facing, hn::Zero(d)));
      sums.count += static_cast<std::uint32_t>(hn::CountTrue(d, seen));
      hn::Store(hn::IfThenElseZero(seen, hn::Sqrt(dot(normal, normal))), d, wholes.data() + i);
      hn::Store(hn::IfThenElseZero(seen, hn::Div(hn::Abs(facing), distance)), d, facings.data() + i);
    }
    for (std::size_t i = 0; i < corners.inserted; ++i) {
      sums.whole += wholes[i];
      sums.facing += facings[i];
    }
  }

  const FanCorners& corners;
  glm::vec3 eye;
  bool two_sided;
  SeenFaces sums;
};

SeenFaces seen_faces(const FanCorners& corners, const glm::vec3& eye, bool two_sided) {
  const Floats d;
  FaceSums faces(corners, eye, two_sided);
  faces.add(corners.vertex, [&](Vec lane) HWY_ATTR { return hn::Eq(lane, lane); });
  const std::uint32_t u = corners.parent_place;
  const Vec at_u = hn::Set(d, static_cast<float>(u));
  const Vec before_u = hn::Set(d, static_cast<float>(u == 0 ? corners.ring_size - 1 : u - 1));
  faces.add({corners.x[u], corners.y[u], corners.z[u]},
            [&](Vec lane) HWY_ATTR { return hn::And(hn::Ne(lane, at_u), hn::Ne(lane, before_u)); });
  return faces.sums;
}

}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {
namespace {

HWY_EXPORT(sphere_of);
HWY_EXPORT(seen_faces);

}  // namespace

void FanCorners::fill_up() {
  set(ring_size, {x[0], y[0], z[0]});
  const auto fill = [&](Lanes& lanes, float value) { std::fill_n(lanes.data() + ring_size + 1, most_lanes, value); };
  fill(x, vertex.x);
  fill(y, vertex.y);
  fill(z, vertex.z);
}

Sphere sphere_around(const FanCorners& corners) { return HWY_DYNAMIC_DISPATCH(sphere_of)(corners); }

SeenFaces fan_visibility(const FanCorners& corners, const glm::vec3& eye, bool two_sided) {
  return HWY_DYNAMIC_DISPATCH(seen_faces)(corners, eye, two_sided);
}

}  // namespace occlod
#endif  // HWY_ONCE
