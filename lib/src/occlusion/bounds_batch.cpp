#include "occlusion/bounds_batch.h"

#include <cassert>
#include <glm/gtc/matrix_access.hpp>
#include <limits>

#include "occlusion/bounds_slack.h"

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "occlusion/bounds_batch.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::ScalableTag<double>;
using Floats = hn::Rebind<float, Doubles>;
using Ints = hn::Rebind<std::int32_t, Doubles>;
using Vec = hn::Vec<Doubles>;
using FloatVec = hn::Vec<Floats>;
using IntVec = hn::Vec<Ints>;
using Mask = hn::Mask<Doubles>;

HWY_INLINE Vec constant(double value) { return hn::Set(Doubles(), value); }

struct Vec3 {
  Vec x, y, z;
};

HWY_INLINE Vec3 constant(const glm::dvec3& v) { return {constant(v.x), constant(v.y), constant(v.z)}; }

HWY_INLINE Vec load(const PerBound<float>& values, std::size_t i) {
  return hn::PromoteTo(Doubles(), hn::LoadU(Floats(), values.data() + i));
}

HWY_INLINE Vec3 load(const std::array<PerBound<float>, 3>& values, std::size_t i) {
  return {load(values[0], i), load(values[1], i), load(values[2], i)};
}

HWY_INLINE Vec dot(const Vec3& a, const Vec3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE Vec at(const glm::dvec4& row, const Vec3& p) {
  return hn::Add(dot(constant(glm::dvec3(row)), p), constant(row.w));
}

HWY_INLINE Vec3 abs(const Vec3& v) { return {hn::Abs(v.x), hn::Abs(v.y), hn::Abs(v.z)}; }
HWY_INLINE Vec3 max(const Vec3& a, const Vec3& b) { return {hn::Max(a.x, b.x), hn::Max(a.y, b.y), hn::Max(a.z, b.z)}; }

// The inner products whose unit balls are the shapes, as in screen_bounds.
struct BallProduct {
  HWY_INLINE Vec operator()(const Vec3& a, const Vec3& b) const { return dot(a, b); }
};
struct DiscProduct {
  Vec3 axis;
  HWY_INLINE Vec operator()(const Vec3& a, const Vec3& b) const {
    return hn::Sub(dot(a, b), hn::Mul(dot(a, axis), dot(b, axis)));
  }
};

// As Extent in screen_bounds.cpp, operation by operation.
class ExtentLanes {
 public:
  HWY_INLINE explicit ExtentLanes(const BoundsView& view)
      : view_(view),
        low_x_(constant(std::numeric_limits<double>::infinity())),
        high_x_(hn::Neg(low_x_)),
        low_y_(low_x_),
        high_y_(high_x_),
        smallest_w_(low_x_),
        largest_(constant(glm::dvec3(0.0))),
        trusted_(hn::Eq(low_x_, low_x_)) {}

  HWY_INLINE void add_box(const Vec3& low, const Vec3& high) {
    for (int i = 0; i < 8; ++i)
      add_point({(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y, (i & 4) != 0 ? high.z : low.z});
  }

  HWY_INLINE void add_point(const Vec3& p) {
    const Vec w = at(view_.w, p);
    add_depths(w, at(view_.z + view_.w, p));
    largest_ = max(largest_, abs(p));
    const Vec x = hn::Div(at(view_.x, p), w);
    const Vec y = hn::Div(at(view_.y, p), w);
    add_range(low_x_, high_x_, x, x);
    add_range(low_y_, high_y_, y, y);
  }

  template <class Product>
  HWY_INLINE void add_round(const Vec3& center, Vec radius, const Product& product) {
    const Vec w = at(view_.w, center);
    const auto spread = [&](const glm::dvec4& row) {
      const Vec3 v = constant(glm::dvec3(row));
      return hn::Mul(radius, hn::Sqrt(hn::Max(product(v, v), constant(0.0))));
    };
    add_depths(hn::Sub(w, spread(view_.w)), hn::Sub(at(view_.z + view_.w, center), spread(view_.z + view_.w)));
    trust(hn::Ge(radius, constant(0.0)));
    const Vec3 reach = abs(center);
    largest_ = max(largest_, {hn::Add(reach.x, radius), hn::Add(reach.y, radius), hn::Add(reach.z, radius)});
    add_silhouette(view_.x, center, radius, w, product, low_x_, high_x_);
    add_silhouette(view_.y, center, radius, w, product, low_y_, high_y_);
  }

  HWY_INLINE void store(BoundsOutput& output, std::size_t i) const {
    const Vec rounding = constant(bounds_rounding);
    const Vec w_error = hn::Mul(rounding, magnitude(view_.w));
    const Vec nearest_w = hn::Sub(smallest_w_, w_error);
    const Vec ratio_x = hn::Max(hn::Abs(low_x_), hn::Abs(high_x_));
    const Vec ratio_y = hn::Max(hn::Abs(low_y_), hn::Abs(high_y_));
    const Vec error_x = hn::Div(hn::Add(hn::Mul(rounding, magnitude(view_.x)), hn::Mul(w_error, ratio_x)), nearest_w);
    const Vec error_y = hn::Div(hn::Add(hn::Mul(rounding, magnitude(view_.y)), hn::Mul(w_error, ratio_y)), nearest_w);
    const Mask rows = store_range(low_x_, high_x_, error_x, view_.size.x, output.x0.data() + i, output.x1.data() + i);
    const Mask columns = store_range(hn::Neg(high_y_), hn::Neg(low_y_), error_y, view_.size.y, output.y0.data() + i,
                                     output.y1.data() + i);
    store_nearest(hn::Div(constant(1.0 + bounds_rounding), nearest_w), output.nearest_inverse_depth.data() + i);
    const Mask trusted = hn::And(hn::And(trusted_, hn::Gt(nearest_w, constant(0.0))), hn::And(rows, columns));
    hn::StoreU(hn::DemoteTo(Ints(), hn::IfThenElseZero(trusted, constant(1.0))), Ints(), output.trusted.data() + i);
  }

  // Lane 0 of the result holds the extent of all lanes.
  HWY_INLINE void reduce() {
    const Doubles d;
    low_x_ = hn::MinOfLanes(d, low_x_);
    high_x_ = hn::MaxOfLanes(d, high_x_);
    low_y_ = hn::MinOfLanes(d, low_y_);
    high_y_ = hn::MaxOfLanes(d, high_y_);
    smallest_w_ = hn::MinOfLanes(d, smallest_w_);
    largest_ = {hn::MaxOfLanes(d, largest_.x), hn::MaxOfLanes(d, largest_.y), hn::MaxOfLanes(d, largest_.z)};
    if (!hn::AllTrue(d, trusted_)) trusted_ = hn::Lt(constant(0.0), constant(0.0));
  }

 private:
  HWY_INLINE void trust(Mask mask) { trusted_ = hn::And(trusted_, mask); }

  HWY_INLINE void add_depths(Vec smallest_w, Vec before_near) {
    trust(hn::And(hn::And(hn::Gt(smallest_w, constant(0.0)),
                          hn::Lt(smallest_w, constant(std::numeric_limits<double>::infinity()))),
                  hn::Ge(before_near, constant(0.0))));
    smallest_w_ = hn::Min(smallest_w_, smallest_w);
  }

  HWY_INLINE void add_range(Vec& low, Vec& high, Vec new_low, Vec new_high) {
    trust(hn::Le(new_low, new_high));
    low = hn::Min(low, new_low);
    high = hn::Max(high, new_high);
  }

  template <class Product>
  HWY_INLINE void add_silhouette(const glm::dvec4& row, const Vec3& center, Vec radius, Vec w, const Product& product,
                                 Vec& low, Vec& high) {
    const Vec3 a = constant(glm::dvec3(row)), b = constant(glm::dvec3(view_.w));
    const Vec x = at(row, center);
    const Vec aa = product(a, a), ab = product(a, b), bb = product(b, b);
    const Vec rr = hn::Mul(radius, radius);
    const Vec3 across = {hn::Sub(hn::Mul(x, b.x), hn::Mul(w, a.x)), hn::Sub(hn::Mul(x, b.y), hn::Mul(w, a.y)),
                         hn::Sub(hn::Mul(x, b.z), hn::Mul(w, a.z))};
    const Vec square = hn::Sub(product(across, across), hn::Mul(rr, hn::Sub(hn::Mul(aa, bb), hn::Mul(ab, ab))));
    const Vec root = hn::Mul(radius, hn::Sqrt(hn::Max(square, constant(0.0))));
    const Vec middle = hn::Sub(hn::Mul(x, w), hn::Mul(rr, ab));
    const Vec lead = hn::Sub(hn::Mul(w, w), hn::Mul(rr, bb));
    trust(hn::Gt(lead, constant(0.0)));
    add_range(low, high, hn::Div(hn::Sub(middle, root), lead), hn::Div(hn::Add(middle, root), lead));
  }

  HWY_INLINE Vec magnitude(const glm::dvec4& row) const {
    return hn::Add(dot(abs(constant(glm::dvec3(row))), largest_), constant(row.w < 0.0 ? -row.w : row.w));
  }

  static HWY_INLINE Vec to_pixels(Vec ratio, double size) {
    return hn::Mul(hn::Add(hn::Mul(ratio, constant(0.5)), constant(0.5)), constant(size));
  }

  // Pixels [*begin, *end) of one axis from the range of x / w or -y / w; false where it is no range.
  static HWY_INLINE Mask store_range(Vec low_ratio, Vec high_ratio, Vec error, double size, std::int32_t* begin,
                                     std::int32_t* end) {
    const Vec zero = constant(0.0), limit = constant(size);
    const Vec slack = hn::Add(hn::Mul(error, constant(size / 2.0)), constant(bounds_slack_px));
    const Vec low = hn::Sub(to_pixels(low_ratio, size), slack);
    const Vec high = hn::Add(to_pixels(high_ratio, size), slack);
    // Truncation is floor where nothing is negative; a negative high end has its floor + 1 at 0 or below.
    const Ints ints;
    const IntVec last = hn::DemoteTo(ints, hn::Min(hn::Max(high, zero), limit));
    const IntVec one = hn::DemoteTo(ints, hn::IfThenElseZero(hn::Ge(high, zero), constant(1.0)));
    hn::StoreU(hn::DemoteTo(ints, hn::Min(hn::Max(low, zero), limit)), ints, begin);
    hn::StoreU(hn::Min(hn::Add(last, one), hn::Set(ints, static_cast<std::int32_t>(size))), ints, end);
    return hn::Le(low, high);
  }

  // Rounded and then one step up: std::nextafter of what is positive, infinity included.
  static HWY_INLINE void store_nearest(Vec value, float* out) {
    const Ints ints;
    const IntVec infinity = hn::BitCast(ints, hn::Set(Floats(), std::numeric_limits<float>::infinity()));
    const IntVec bits = hn::BitCast(ints, hn::DemoteTo(Floats(), value));
    hn::StoreU(hn::BitCast(Floats(), hn::Min(hn::Add(bits, hn::Set(ints, 1)), infinity)), Floats(), out);
  }

  const BoundsView& view_;
  Vec low_x_, high_x_, low_y_, high_y_, smallest_w_;
  Vec3 largest_;
  Mask trusted_;
};

template <class AddTo>
HWY_INLINE void for_each_lane_group(const BoundsView& view, const BoundsInput& input, BoundsOutput& output,
                                    AddTo&& add_to) {
  for (std::size_t i = 0; i < input.size; i += hn::Lanes(Doubles())) {
    ExtentLanes extent(view);
    add_to(extent, i);
    extent.store(output, i);
  }
}

void bound_boxes(const BoundsView& view, const BoundsInput& input, BoundsOutput& output) {
  for_each_lane_group(view, input, output, [&](ExtentLanes& extent, std::size_t i) HWY_ATTR {
    extent.add_box(load(input.low, i), load(input.high, i));
  });
}

void bound_spheres(const BoundsView& view, const BoundsInput& input, BoundsOutput& output) {
  for_each_lane_group(view, input, output, [&](ExtentLanes& extent, std::size_t i) HWY_ATTR {
    extent.add_round(load(input.center, i), load(input.radius, i), BallProduct());
  });
}

void bound_cylinders(const BoundsView& view, const BoundsInput& input, BoundsOutput& output) {
  for_each_lane_group(view, input, output, [&](ExtentLanes& extent, std::size_t i) HWY_ATTR {
    const Vec3 center = load(input.center, i), axis = load(input.axis, i);
    for (const PerBound<float>* end : {&input.t_min, &input.t_max}) {
      const Vec t = load(*end, i);
      extent.add_round({hn::Add(center.x, hn::Mul(t, axis.x)), hn::Add(center.y, hn::Mul(t, axis.y)),
                        hn::Add(center.z, hn::Mul(t, axis.z))},
                       load(input.radius, i), DiscProduct{axis});
    }
  });
}

// A point to a lane, the last one repeated.
void bound_hull(const BoundsView& view, const glm::vec3* points, std::size_t count, BoundsOutput& output) {
  std::array<PerBound<float>, 3> group;
  ExtentLanes extent(view);
  const std::size_t lanes = hn::Lanes(Doubles());
  for (std::size_t first = 0; first < count; first += lanes) {
    for (std::size_t i = 0; i < lanes; ++i) {
      const glm::vec3& p = points[HWY_MIN(first + i, count - 1)];
      group[0][i] = p.x;
      group[1][i] = p.y;
      group[2][i] = p.z;
    }
    extent.add_point(load(group, 0));
  }
  extent.reduce();
  extent.store(output, 0);
}

}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {
namespace {

HWY_EXPORT(bound_boxes);
HWY_EXPORT(bound_spheres);
HWY_EXPORT(bound_cylinders);
HWY_EXPORT(bound_hull);

void put(std::array<PerBound<float>, 3>& lanes, std::size_t i, const glm::vec3& v) {
  lanes[0][i] = v.x;
  lanes[1][i] = v.y;
  lanes[2][i] = v.z;
}

}  // namespace

BoundsView::BoundsView(const View& view, const ObjectView& object)
    : x(glm::row(object.object_to_clip(), 0)),
      y(glm::row(object.object_to_clip(), 1)),
      z(glm::row(object.object_to_clip(), 2)),
      w(glm::row(object.object_to_clip(), 3)),
      size(view.width(), view.height()) {}

void BoundsInput::push(const Sphere& sphere) {
  assert(size < bounds_batch_size);
  put(center, size, sphere.center);
  radius[size++] = sphere.radius;
}

void BoundsInput::push(const Box& box) {
  assert(size < bounds_batch_size);
  put(low, size, box.min);
  put(high, size++, box.max);
}

void BoundsInput::push(const Cylinder& cylinder) {
  assert(size < bounds_batch_size);
  put(center, size, cylinder.center);
  put(axis, size, cylinder.axis);
  t_min[size] = cylinder.t_min;
  t_max[size] = cylinder.t_max;
  radius[size++] = cylinder.radius;
}

template <>
void find_screen_bounds<Sphere>(const BoundsView& view, const BoundsInput& input, BoundsOutput& output) {
  HWY_DYNAMIC_DISPATCH(bound_spheres)(view, input, output);
}

template <>
void find_screen_bounds<Box>(const BoundsView& view, const BoundsInput& input, BoundsOutput& output) {
  HWY_DYNAMIC_DISPATCH(bound_boxes)(view, input, output);
}

template <>
void find_screen_bounds<Cylinder>(const BoundsView& view, const BoundsInput& input, BoundsOutput& output) {
  HWY_DYNAMIC_DISPATCH(bound_cylinders)(view, input, output);
}

void find_screen_bounds(const BoundsView& view, std::span<const glm::vec3> points, BoundsOutput& output) {
  HWY_DYNAMIC_DISPATCH(bound_hull)(view, points.data(), points.size(), output);
}

}  // namespace occlod
#endif  // HWY_ONCE
