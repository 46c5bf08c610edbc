#include <algorithm>
#include <cassert>
#include <glm/gtc/matrix_access.hpp>
#include <limits>

#include "raster/depth_kernels.h"
#include "raster/screen_bounds.h"

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/bounds_batch.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#ifndef OCCLOD_OCCLUSION_BOUNDS_BATCH_ONCE
#define OCCLOD_OCCLUSION_BOUNDS_BATCH_ONCE
namespace occlod {

// The fields of all kinds of bounds; each kind uses some of them. Lanes from `size` on hold arbitrary numbers.
struct BoundsInput {
  std::size_t size = 0;
  std::array<PerBound<float>, 3> center, axis;  // of spheres and cylinders
  PerBound<float> radius, t_min, t_max;
  std::array<PerBound<float>, 3> low, high;  // of boxes
};

// Points of hulls, one hull per lane; shorter hulls repeat their first point.
struct HullsInput {
  std::size_t size = 0;
  std::size_t longest = 0;
  std::array<std::array<PerBound<float>, 3>, max_hull_points> points;
};

}  // namespace occlod
#endif  // OCCLOD_OCCLUSION_BOUNDS_BATCH_ONCE

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {
namespace {

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

// The inner products whose unit balls are the shapes, as for add_round() in screen_bounds.cpp.
struct BallProduct {
  HWY_INLINE Vec operator()(const Vec3& a, const Vec3& b) const { return dot(a, b); }
};
struct DiscProduct {
  Vec3 axis;
  HWY_INLINE Vec operator()(const Vec3& a, const Vec3& b) const {
    return hn::Sub(dot(a, b), hn::Mul(dot(a, axis), dot(b, axis)));
  }
};

// A row of the matrix times the corners of a box, in the order of corner().
struct BoxRow {
  HWY_INLINE BoxRow(const glm::dvec4& row, const Vec3& low, const Vec3& high) : w(constant(row.w)) {
    const Vec3 r = constant(glm::dvec3(row));
    const Vec low_x = hn::Mul(r.x, low.x), high_x = hn::Mul(r.x, high.x);
    const Vec low_y = hn::Mul(r.y, low.y), high_y = hn::Mul(r.y, high.y);
    xy[0] = hn::Add(low_x, low_y);
    xy[1] = hn::Add(high_x, low_y);
    xy[2] = hn::Add(low_x, high_y);
    xy[3] = hn::Add(high_x, high_y);
    z[0] = hn::Mul(r.z, low.z);
    z[1] = hn::Mul(r.z, high.z);
  }
  HWY_INLINE Vec at(int i) const { return hn::Add(hn::Add(xy[i & 3], z[i >> 2]), w); }

  Vec xy[4], z[2], w;
};

// Does what Extent in screen_bounds.cpp does, operation by operation.
class ExtentLanes {
 public:
  HWY_INLINE explicit ExtentLanes(const BoundsView& view)
      : view_(view),
        low_x_(constant(std::numeric_limits<double>::infinity())),
        high_x_(hn::Neg(low_x_)),
        low_y_(low_x_),
        high_y_(high_x_),
        smallest_w_(low_x_),
        smallest_before_near_(low_x_),
        largest_(constant(glm::dvec3(0.0))),
        trusted_(hn::Eq(low_x_, low_x_)) {}

  // Corners share the products of their coordinates and the sums of the first two products.
  HWY_INLINE void add_box(const Vec3& low, const Vec3& high) {
    const BoxRow x(view_.x, low, high), y(view_.y, low, high), w(view_.w, low, high),
        near(view_.z + view_.w, low, high);
    largest_ = max(largest_, max(abs(low), abs(high)));
    HWY_UNROLL(8)
    for (int i = 0; i < 8; ++i) add_projected(x.at(i), y.at(i), w.at(i), near.at(i));
  }

  // The quotients x / w and y / w of a point.
  struct Projected {
    Vec x, y;
  };
  HWY_INLINE Projected add_point(const Vec3& p) {
    largest_ = max(largest_, abs(p));
    return add_projected(at(view_.x, p), at(view_.y, p), at(view_.w, p), at(view_.z + view_.w, p));
  }

  template <class Product>
  HWY_INLINE void add_round(const Vec3& center, Vec radius, const Product& product) {
    const Vec w = at(view_.w, center);
    const auto spread = [&](const glm::dvec4& row) HWY_ATTR {
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

  // Stores diagonals from ranges in pixels from the middle of the image. Precondition: the points of the ranges have
  // been added.
  HWY_INLINE void store_diagonals(Vec low_sum, Vec high_sum, Vec low_difference, Vec high_difference,
                                  DiagonalsOutput& output, std::size_t i) const {
    const Doubles d;
    const Vec w_error = hn::Mul(constant(bounds_rounding), magnitude(view_.w));
    const Vec nearest_w = hn::Sub(smallest_w_, w_error);
    const Vec largest = hn::Max(hn::Max(hn::Abs(low_sum), hn::Abs(high_sum)),
                                hn::Max(hn::Abs(low_difference), hn::Abs(high_difference)));
    const Vec error =
        hn::Mul(constant(bounds_rounding / 2.0), hn::Add(hn::Mul(constant(view_.size.x), magnitude(view_.x)),
                                                         hn::Mul(constant(view_.size.y), magnitude(view_.y))));
    const Vec slack =
        hn::Add(hn::Div(hn::Add(error, hn::Mul(w_error, largest)), nearest_w), constant(2.0 * bounds_slack_px));
    const Vec sum = constant((view_.size.x + view_.size.y) / 2.0);
    const Vec difference = constant((view_.size.x - view_.size.y) / 2.0);
    hn::StoreU(hn::Sub(hn::Add(sum, low_sum), slack), d, output.sum_low.data() + i);
    hn::StoreU(hn::Add(hn::Add(sum, high_sum), slack), d, output.sum_high.data() + i);
    hn::StoreU(hn::Sub(hn::Add(difference, low_difference), slack), d, output.difference_low.data() + i);
    hn::StoreU(hn::Add(hn::Add(difference, high_difference), slack), d, output.difference_high.data() + i);
  }

  HWY_INLINE void store(BoundsOutput& output, std::size_t i) const {
    const Vec rounding = constant(bounds_rounding);
    const Vec w_error = hn::Mul(rounding, magnitude(view_.w));
    const Vec nearest_w = hn::Sub(smallest_w_, w_error);
    const Vec ratio_x = hn::Max(hn::Abs(low_x_), hn::Abs(high_x_));
    const Vec ratio_y = hn::Max(hn::Abs(low_y_), hn::Abs(high_y_));
    const Vec inverse_w = hn::Div(constant(1.0), nearest_w);
    const Vec error_x = hn::Mul(hn::Add(hn::Mul(rounding, magnitude(view_.x)), hn::Mul(w_error, ratio_x)), inverse_w);
    const Vec error_y = hn::Mul(hn::Add(hn::Mul(rounding, magnitude(view_.y)), hn::Mul(w_error, ratio_y)), inverse_w);
    const Mask rows = store_range(low_x_, high_x_, error_x, view_.size.x, output.x0.data() + i, output.x1.data() + i);
    const Mask columns = store_range(hn::Neg(high_y_), hn::Neg(low_y_), error_y, view_.size.y, output.y0.data() + i,
                                     output.y1.data() + i);
    const Vec nearness = view_.orthographic ? largest_nearness() : hn::Mul(constant(1.0 + bounds_rounding), inverse_w);
    store_nearest(nearness, output.largest_nearness.data() + i);
    const Mask trusted = hn::And(hn::And(trusted_, hn::Gt(nearest_w, constant(0.0))), hn::And(rows, columns));
    hn::StoreU(hn::DemoteTo(Ints(), hn::IfThenElseZero(trusted, constant(1.0))), Ints(), output.trusted.data() + i);
  }

 private:
  HWY_INLINE void trust(Mask mask) { trusted_ = hn::And(trusted_, mask); }

  HWY_INLINE void add_depths(Vec smallest_w, Vec before_near) {
    trust(hn::And(hn::And(hn::Gt(smallest_w, constant(0.0)),
                          hn::Lt(smallest_w, constant(std::numeric_limits<double>::infinity()))),
                  hn::Ge(before_near, constant(0.0))));
    smallest_w_ = hn::Min(smallest_w_, smallest_w);
    smallest_before_near_ = hn::Min(smallest_before_near_, before_near);
  }

  HWY_INLINE Vec largest_nearness() const {
    const Vec one = constant(1.0);
    const Vec rounding = hn::Mul(constant(bounds_rounding), hn::Add(magnitude(view_.z), one));
    const Vec nearest = hn::Add(hn::Sub(one, hn::Mul(constant(0.5), smallest_before_near_)), rounding);
    return hn::Max(nearest, constant(0.0));
  }

  HWY_INLINE Projected add_projected(Vec x, Vec y, Vec w, Vec before_near) {
    add_depths(w, before_near);
    const Vec inverse_w = hn::Div(constant(1.0), w);
    const Vec ratio_x = hn::Mul(x, inverse_w);
    const Vec ratio_y = hn::Mul(y, inverse_w);
    add_range(low_x_, high_x_, ratio_x, ratio_x);
    add_range(low_y_, high_y_, ratio_y, ratio_y);
    return {ratio_x, ratio_y};
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
    const Vec inverse = hn::Div(constant(1.0), lead);
    add_range(low, high, hn::Mul(hn::Sub(middle, root), inverse), hn::Mul(hn::Add(middle, root), inverse));
  }

  HWY_INLINE Vec magnitude(const glm::dvec4& row) const {
    return hn::Add(dot(abs(constant(glm::dvec3(row))), largest_), constant(row.w < 0.0 ? -row.w : row.w));
  }

  static HWY_INLINE Vec to_pixels(Vec ratio, double size) {
    return hn::Mul(hn::Add(hn::Mul(ratio, constant(0.5)), constant(0.5)), constant(size));
  }

  // Stores the pixels [*begin, *end) of one axis from the range of x / w or -y / w; false where the range is empty or
  // NaN.
  static HWY_INLINE Mask store_range(Vec low_ratio, Vec high_ratio, Vec error, double size, std::int32_t* begin,
                                     std::int32_t* end) {
    const Vec zero = constant(0.0), limit = constant(size);
    const Vec slack = hn::Add(hn::Mul(error, constant(size / 2.0)), constant(bounds_slack_px));
    const Vec low = hn::Sub(to_pixels(low_ratio, size), slack);
    const Vec high = hn::Add(to_pixels(high_ratio, size), slack);
    // Truncation is floor for numbers that are not negative; for a negative high end, floor + 1 is at most 0.
    const Ints ints;
    const IntVec last = hn::DemoteTo(ints, hn::Min(hn::Max(high, zero), limit));
    const IntVec one = hn::DemoteTo(ints, hn::IfThenElseZero(hn::Ge(high, zero), constant(1.0)));
    hn::StoreU(hn::DemoteTo(ints, hn::Min(hn::Max(low, zero), limit)), ints, begin);
    hn::StoreU(hn::Min(hn::Add(last, one), hn::Set(ints, static_cast<std::int32_t>(size))), ints, end);
    return hn::Le(low, high);
  }

  // Rounds and then steps up once, as std::nextafter does for positive numbers, including infinity.
  static HWY_INLINE void store_nearest(Vec value, float* out) {
    const Ints ints;
    const IntVec infinity = hn::BitCast(ints, hn::Set(Floats(), std::numeric_limits<float>::infinity()));
    const IntVec bits = hn::BitCast(ints, hn::DemoteTo(Floats(), value));
    hn::StoreU(hn::BitCast(Floats(), hn::Min(hn::Add(bits, hn::Set(ints, 1)), infinity)), Floats(), out);
  }

  const BoundsView& view_;
  Vec low_x_, high_x_, low_y_, high_y_, smallest_w_, smallest_before_near_;
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

void bound_hulls(const BoundsView& view, const HullsInput& input, BoundsOutput& output, DiagonalsOutput& diagonals) {
  const Vec infinity = constant(std::numeric_limits<double>::infinity());
  const Vec half_width = constant(0.5 * view.size.x), half_height = constant(0.5 * view.size.y);
  for (std::size_t i = 0; i < input.size; i += hn::Lanes(Doubles())) {
    ExtentLanes extent(view);
    Vec low_sum = infinity, high_sum = hn::Neg(infinity), low_difference = low_sum, high_difference = high_sum;
    for (std::size_t k = 0; k < input.longest; ++k) {
      const ExtentLanes::Projected at = extent.add_point(load(input.points[k], i));
      const Vec x = hn::Mul(at.x, half_width), y = hn::Mul(at.y, half_height);  // y points up in clip space
      low_sum = hn::Min(low_sum, hn::Sub(x, y));
      high_sum = hn::Max(high_sum, hn::Sub(x, y));
      low_difference = hn::Min(low_difference, hn::Add(x, y));
      high_difference = hn::Max(high_difference, hn::Add(x, y));
    }
    extent.store(output, i);
    extent.store_diagonals(low_sum, high_sum, low_difference, high_difference, diagonals, i);
  }
}

void project_points(const BoundsView& view, const std::array<PerBound<float>, 3>& points, std::size_t count,
                    PointsOutput& output) {
  const Vec zero = constant(0.0), half = constant(0.5);
  for (std::size_t i = 0; i < count; i += hn::Lanes(Doubles())) {
    const Vec3 p = load(points, i);
    const Vec w = at(view.w, p), z = at(view.z, p);
    const Vec inverse_w = hn::Div(constant(1.0), w);
    const Vec x = hn::Mul(hn::Add(hn::Mul(hn::Mul(at(view.x, p), inverse_w), half), half), constant(view.size.x));
    const Vec y = hn::Mul(hn::Sub(half, hn::Mul(hn::Mul(at(view.y, p), inverse_w), half)), constant(view.size.y));
    const Mask before = hn::And(hn::Gt(w, zero), hn::Ge(hn::Add(z, w), zero));
    const Mask inside = hn::And(hn::And(hn::Ge(x, zero), hn::Lt(x, constant(view.size.x))),
                                hn::And(hn::Ge(y, zero), hn::Lt(y, constant(view.size.y))));
    const Mask on_screen = hn::And(before, inside);
    const Vec nearness = view.orthographic ? hn::Mul(hn::Sub(w, z), half) : inverse_w;
    hn::StoreU(hn::DemoteTo(Ints(), hn::IfThenElseZero(on_screen, x)), Ints(), output.x.data() + i);
    hn::StoreU(hn::DemoteTo(Ints(), hn::IfThenElseZero(on_screen, y)), Ints(), output.y.data() + i);
    hn::StoreU(hn::DemoteTo(Ints(), hn::IfThenElseZero(on_screen, constant(1.0))), Ints(), output.on_screen.data() + i);
    hn::StoreU(hn::DemoteTo(Floats(), hn::IfThenElseZero(on_screen, nearness)), Floats(), output.nearness.data() + i);
  }
}

}  // namespace
}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {
namespace {

HWY_EXPORT(bound_boxes);
HWY_EXPORT(bound_spheres);
HWY_EXPORT(bound_cylinders);
HWY_EXPORT(bound_hulls);
HWY_EXPORT(project_points);

void put(std::array<PerBound<float>, 3>& lanes, std::size_t i, const glm::vec3& v) {
  lanes[0][i] = v.x;
  lanes[1][i] = v.y;
  lanes[2][i] = v.z;
}

}  // namespace

BoundsView::BoundsView(const View& view, const ObjectView& object, float nearness_scale)
    : x(glm::row(object.object_to_clip(), 0)),
      y(glm::row(object.object_to_clip(), 1)),
      z(glm::row(object.object_to_clip(), 2)),
      w(glm::row(object.object_to_clip(), 3)),
      size(view.width(), view.height()),
      orthographic(view.is_orthographic()) {
  const double divided = 1.0 / static_cast<double>(nearness_scale);
  for (glm::dvec4* row : {&x, &y, &z, &w}) *row *= divided;
}

void find_screen_bounds(const BoundsView& view, std::span<const Sphere> spheres, BoundsOutput& output) {
  assert(spheres.size() <= bounds_batch_size);
  BoundsInput input;
  for (const Sphere& sphere : spheres) {
    put(input.center, input.size, sphere.center);
    input.radius[input.size++] = sphere.radius;
  }
  HWY_DYNAMIC_DISPATCH(bound_spheres)(view, input, output);
}

void find_screen_bounds(const BoundsView& view, std::span<const Box> boxes, BoundsOutput& output) {
  assert(boxes.size() <= bounds_batch_size);
  BoundsInput input;
  for (const Box& box : boxes) {
    put(input.low, input.size, box.min);
    put(input.high, input.size++, box.max);
  }
  HWY_DYNAMIC_DISPATCH(bound_boxes)(view, input, output);
}

void find_screen_bounds(const BoundsView& view, std::span<const Cylinder> cylinders, BoundsOutput& output) {
  assert(cylinders.size() <= bounds_batch_size);
  BoundsInput input;
  for (const Cylinder& cylinder : cylinders) {
    put(input.center, input.size, cylinder.center);
    put(input.axis, input.size, cylinder.axis);
    input.t_min[input.size] = cylinder.t_min;
    input.t_max[input.size] = cylinder.t_max;
    input.radius[input.size++] = cylinder.radius;
  }
  HWY_DYNAMIC_DISPATCH(bound_cylinders)(view, input, output);
}

void find_screen_bounds(const BoundsView& view, std::span<const PointHull> hulls, BoundsOutput& output,
                        DiagonalsOutput& diagonals) {
  assert(hulls.size() <= bounds_batch_size);
  HullsInput input;
  input.size = hulls.size();
  for (const PointHull& hull : hulls) input.longest = std::max(input.longest, hull.points.size());
  assert(input.longest <= max_hull_points);
  for (std::size_t i = 0; i < hulls.size(); ++i)
    for (std::size_t k = 0; k < input.longest; ++k)
      put(input.points[k], i, hulls[i].points[k < hulls[i].points.size() ? k : 0]);
  HWY_DYNAMIC_DISPATCH(bound_hulls)(view, input, output, diagonals);
}

void find_pixels(const BoundsView& view, std::span<const glm::vec3> points, PointsOutput& output) {
  assert(points.size() <= bounds_batch_size);
  std::array<PerBound<float>, 3> lanes;
  for (std::size_t i = 0; i < points.size(); ++i) put(lanes, i, points[i]);
  HWY_DYNAMIC_DISPATCH(project_points)(view, lanes, points.size(), output);
}

}  // namespace occlod
#endif  // HWY_ONCE
