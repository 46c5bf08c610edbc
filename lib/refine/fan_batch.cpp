#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

#include "refine/star_visibility.h"

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refine/fan_batch.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "refine/bounds_lanes-inl.h"
#include "splits/star.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {
namespace {

using Fans = hn::CappedTag<float, FanBatch::capacity>;
using FanVec = hn::Vec<Fans>;
using FanMask = hn::Mask<Fans>;
using Point = Vec3<Fans>;
using PerFan = FanBatch::PerFan<float>;

HWY_INLINE FanVec set(float value) { return hn::Set(Fans(), value); }
HWY_INLINE FanVec load(const PerFan& values, std::size_t i) { return hn::LoadU(Fans(), values.data() + i); }
HWY_INLINE void store(FanVec values, PerFan& out, std::size_t i) { hn::StoreU(values, Fans(), out.data() + i); }

HWY_INLINE FanVec difference(FanVec a, FanVec b, FanVec c, FanVec d) { return hn::Sub(hn::Mul(a, b), hn::Mul(c, d)); }
HWY_INLINE Point cross(const Point& a, const Point& b) {
  return {difference(a.y, b.z, b.y, a.z), difference(a.z, b.x, b.z, a.x), difference(a.x, b.y, b.x, a.y)};
}
HWY_INLINE Point min(const Point& a, const Point& b) {
  return {hn::Min(a.x, b.x), hn::Min(a.y, b.y), hn::Min(a.z, b.z)};
}
HWY_INLINE Point max(const Point& a, const Point& b) {
  return {hn::Max(a.x, b.x), hn::Max(a.y, b.y), hn::Max(a.z, b.z)};
}
HWY_INLINE FanVec middle(FanVec low, FanVec high) { return hn::Add(hn::Mul(set(0.5F), low), hn::Mul(set(0.5F), high)); }

HWY_INLINE Point corner(const FanBatch::Corners& corners, std::size_t place, std::size_t i) {
  return {load(corners.x[place], i), load(corners.y[place], i), load(corners.z[place], i)};
}

// Sums over the faces of a fan around one of its vertices that face the eye.
struct SeenFaces {
  HWY_INLINE SeenFaces(const Point& vertex, const glm::vec3& eye, bool both_sides)
      : apex(vertex),
        to_eye(subtract(Point{set(eye.x), set(eye.y), set(eye.z)}, vertex)),
        facing(hn::Zero(Fans())),
        two_sided(both_sides) {}

  // Adds the face (apex, a, b). `faces` and `whole` are sums over inserted and removed faces.
  HWY_INLINE void add(const Point& a, const Point& b, FanMask is_face, FanVec& faces, FanVec& whole) {
    const FanVec zero = hn::Zero(Fans());
    const Point normal = cross(subtract(a, apex), subtract(b, apex));
    FanVec towards = dot(normal, to_eye);
    if (two_sided)
      towards = hn::Abs(towards);
    else
      is_face = hn::And(is_face, hn::Gt(towards, zero));
    faces = hn::Add(faces, hn::IfThenElseZero(is_face, set(1.0F)));
    whole = hn::Add(whole, hn::IfThenElseZero(is_face, hn::Sqrt(dot(normal, normal))));
    facing = hn::Add(facing, hn::IfThenElseZero(is_face, towards));
  }
  // Returns the sum with the direction to the eye scaled to unit length.
  HWY_INLINE FanVec facing_sum() const { return hn::Div(facing, hn::Sqrt(dot(to_eye, to_eye))); }

  Point apex, to_eye;
  FanVec facing;
  bool two_sided;
};

HWY_INLINE void view_faces(const FanBatch& batch, std::size_t i, const ObjectView& view, bool two_sided,
                           FanViews& views) {
  const FanBatch::Corners& corners = batch.corners();
  const FanVec inserted = load(corners.inserted, i), parent_place = load(corners.parent_place, i),
               before_parent = load(corners.place_before_parent, i);
  const Point vertex = {load(corners.vertex_x, i), load(corners.vertex_y, i), load(corners.vertex_z, i)};
  SeenFaces inserted_faces(vertex, view.eye(), two_sided);
  SeenFaces removed_faces({load(corners.parent_x, i), load(corners.parent_y, i), load(corners.parent_z, i)}, view.eye(),
                          two_sided);
  FanVec faces = hn::Zero(Fans()), whole = faces;
  Point low = vertex, high = vertex, a = corner(corners, 0, i);
  for (std::size_t place = 0; place < batch.longest(); ++place) {
    const Point b = corner(corners, place + 1, i);
    low = min(low, b);
    high = max(high, b);
    const FanVec at = set(static_cast<float>(place));
    const FanMask is_inserted = hn::Lt(at, inserted);
    inserted_faces.add(a, b, is_inserted, faces, whole);
    const FanMask is_removed = hn::And(is_inserted, hn::And(hn::Ne(at, parent_place), hn::Ne(at, before_parent)));
    removed_faces.add(a, b, is_removed, faces, whole);
    a = b;
  }
  a = corner(corners, 0, i);
  low = min(low, a);
  high = max(high, a);
  const Point center = {middle(low.x, high.x), middle(low.y, high.y), middle(low.z, high.z)};
  Point off = subtract(center, vertex);
  FanVec farthest = dot(off, off);
  for (std::size_t place = 0; place <= batch.longest(); ++place) {
    off = subtract(center, corner(corners, place, i));
    farthest = hn::Max(farthest, dot(off, off));
  }
  const FanVec radius = hn::Sqrt(farthest);
  FanVec room = set(std::numeric_limits<float>::infinity());
  for (const glm::vec4& plane : view.planes()) {
    const FanVec distance = hn::Add(dot(Point{set(plane.x), set(plane.y), set(plane.z)}, center), set(plane.w));
    room = hn::Min(room, hn::Sub(distance, radius));
  }
  store(center.x, views.center_x, i);
  store(center.y, views.center_y, i);
  store(center.z, views.center_z, i);
  store(radius, views.radius, i);
  store(room, views.room_inside, i);
  store(faces, views.faces, i);
  store(whole, views.whole, i);
  store(hn::Add(inserted_faces.facing_sum(), removed_faces.facing_sum()), views.facing, i);
}

void find_views(const FanBatch& batch, const ObjectView& view, bool two_sided, FanViews& views) {
  for (std::size_t i = 0; i < batch.size(); i += hn::Lanes(Fans())) view_faces(batch, i, view, two_sided, views);
  for (std::size_t i = 0; i < batch.size(); i += hn::Lanes(Doubles())) {
    const auto wide_lanes = [&](const PerFan& values) HWY_ATTR { return wide(hn::LoadU(Floats(), values.data() + i)); };
    const Vec3<Doubles> center = {wide_lanes(views.center_x), wide_lanes(views.center_y), wide_lanes(views.center_z)};
    hn::StoreU(scale_px(center, wide_lanes(views.radius), view).scale_px, Floats(), views.scale_px.data() + i);
  }
}

}  // namespace
}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {
namespace {

HWY_EXPORT(find_views);

}  // namespace

void FanBatch::add(const SplitStar& star, std::span<const glm::vec3> positions) {
  assert(star.is_fan() && size_ < capacity);
  const std::size_t i = size_++;
  const std::span<const VertexId> ring = star.ring();
  std::size_t parent_place = 0;
  const auto put = [&](std::size_t place, const glm::vec3& p) {
    corners_.x[place][i] = p.x;
    corners_.y[place][i] = p.y;
    corners_.z[place][i] = p.z;
  };
  for (std::size_t place = 0; place < ring.size(); ++place) {
    put(place, positions[ring[place]]);
    if (ring[place] == star.parent_vertex()) parent_place = place;
  }
  const glm::vec3 &vertex = positions[star.vertex()], &parent = positions[ring[parent_place]];
  const glm::vec3& first = positions[ring[0]];
  corners_.vertex_x[i] = vertex.x;
  corners_.vertex_y[i] = vertex.y;
  corners_.vertex_z[i] = vertex.z;
  corners_.parent_x[i] = parent.x;
  corners_.parent_y[i] = parent.y;
  corners_.parent_z[i] = parent.z;
  corners_.inserted[i] = static_cast<float>(star.inserted_count());
  corners_.parent_place[i] = static_cast<float>(parent_place);
  corners_.place_before_parent[i] = static_cast<float>(parent_place == 0 ? ring.size() - 1 : parent_place - 1);
  // Rings repeat their first vertex up to the length of the longest one, which may be the new one.
  const std::size_t before = std::exchange(longest_, std::max(longest_, ring.size()));
  for (std::size_t place = ring.size(); place <= longest_; ++place) put(place, first);
  for (std::size_t place = before + 1; place <= longest_; ++place)
    for (std::size_t other = 0; other < i; ++other) {
      corners_.x[place][other] = corners_.x[0][other];
      corners_.y[place][other] = corners_.y[0][other];
      corners_.z[place][other] = corners_.z[0][other];
    }
}

void find_fan_views(const FanBatch& batch, const ObjectView& view, bool two_sided, FanViews& views) {
  HWY_DYNAMIC_DISPATCH(find_views)(batch, view, two_sided, views);
}

}  // namespace occlod
#endif  // HWY_ONCE
