#include "raster/screen_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <limits>

namespace occlod {
namespace {

// Collects the convex parts of one bound: the range of x / w and y / w, and the smallest w. With `diagonal` the ranges
// are those of the sum and the difference of the pixel coordinates, measured from the middle of the image.
class Extent {
 public:
  Extent(const View& view, const ObjectView& object, bool diagonal)
      : x_(glm::row(object.object_to_clip(), 0)),
        y_(glm::row(object.object_to_clip(), 1)),
        z_(glm::row(object.object_to_clip(), 2)),
        w_(glm::row(object.object_to_clip(), 3)),
        orthographic_(object.is_orthographic()),
        size_(view.width(), view.height()),
        // y points up in clip space.
        first_(diagonal ? (size_.x * x_ - size_.y * y_) * 0.5 : x_),
        second_(diagonal ? (size_.x * x_ + size_.y * y_) * 0.5 : y_) {}

  void add_point(const glm::dvec3& p) {
    const double w = add_depths(p, [](const glm::dvec3&) { return 0.0; });
    if (!trusted_) return;
    const double inverse_w = 1.0 / w;
    add_range(0, at(first_, p) * inverse_w, at(first_, p) * inverse_w);
    add_range(1, at(second_, p) * inverse_w, at(second_, p) * inverse_w);
  }

  void add_sphere(const glm::dvec3& center, double radius) {
    add_round(center, radius, [](const glm::dvec3& a, const glm::dvec3& b) { return glm::dot(a, b); });
  }

  // Adds a disc around `center` that is normal to the unit vector `axis`.
  void add_disc(const glm::dvec3& center, double radius, const glm::dvec3& axis) {
    add_round(center, radius, [&](const glm::dvec3& a, const glm::dvec3& b) {
      return glm::dot(a, b) - glm::dot(a, axis) * glm::dot(b, axis);
    });
  }

  [[nodiscard]] std::optional<ScreenBounds> result() const {
    if (!trusted_) return std::nullopt;
    const double w_error = bounds_rounding * magnitude(w_);
    const double nearest_w = smallest_w_ - w_error;
    if (!(nearest_w > 0.0)) return std::nullopt;
    const double inverse_w = 1.0 / nearest_w;
    ScreenBounds bounds;
    const double nearness = orthographic_ ? largest_nearness() : (1.0 + bounds_rounding) * inverse_w;
    bounds.largest_nearness = std::nextafter(static_cast<float>(nearness), std::numeric_limits<float>::infinity());
    const glm::dvec2 error((bounds_rounding * magnitude(x_) + w_error * largest_ratio(0)) * inverse_w,
                           (bounds_rounding * magnitude(y_) + w_error * largest_ratio(1)) * inverse_w);
    const glm::dvec2 slack = error * (size_ / 2.0) + bounds_slack_px;
    const glm::dvec2 low = (glm::dvec2(low_.x, -high_.y) * 0.5 + 0.5) * size_ - slack;
    const glm::dvec2 high = (glm::dvec2(high_.x, -low_.y) * 0.5 + 0.5) * size_ + slack;
    if (!(low.x <= high.x && low.y <= high.y)) return std::nullopt;
    // The last pixel contains the high end, even when that is exactly on its border.
    bounds.rect.x0 = static_cast<int>(std::clamp(std::floor(low.x), 0.0, size_.x));
    bounds.rect.y0 = static_cast<int>(std::clamp(std::floor(low.y), 0.0, size_.y));
    bounds.rect.x1 = static_cast<int>(std::clamp(std::floor(high.x) + 1.0, 0.0, size_.x));
    bounds.rect.y1 = static_cast<int>(std::clamp(std::floor(high.y) + 1.0, 0.0, size_.y));
    return bounds;
  }

  [[nodiscard]] Diagonals diagonals() const {
    if (!trusted_) return {};
    const double w_error = bounds_rounding * magnitude(w_);
    const double nearest_w = smallest_w_ - w_error;
    if (!(nearest_w > 0.0)) return {};
    const double error = bounds_rounding * (size_.x * magnitude(x_) + size_.y * magnitude(y_)) / 2.0;
    const double largest = std::max(largest_ratio(0), largest_ratio(1));
    const double slack = (error + w_error * largest) / nearest_w + 2.0 * bounds_slack_px;
    const double sum = (size_.x + size_.y) / 2.0, difference = (size_.x - size_.y) / 2.0;
    return {sum + low_[0] - slack, sum + high_[0] + slack, difference + low_[1] - slack, difference + high_[1] + slack};
  }

 private:
  static double at(const glm::dvec4& row, const glm::dvec3& p) { return glm::dot(glm::dvec3(row), p) + row.w; }

  // Returns a bound on the terms of row * p before they cancel, for every point added so far; rounding errors are
  // relative to it.
  [[nodiscard]] double magnitude(const glm::dvec4& row) const {
    return glm::dot(glm::abs(glm::dvec3(row)), largest_coordinate_) + std::abs(row.w);
  }
  // Returns the largest nearness in an orthographic view, where z + w falls from 2 on the near plane to 0 on the far
  // plane; w = 1 does not round.
  [[nodiscard]] double largest_nearness() const {
    const double rounding = bounds_rounding * (magnitude(z_) + 1.0);
    return std::max(1.0 - 0.5 * smallest_before_near_ + rounding, 0.0);
  }
  [[nodiscard]] double largest_ratio(int axis) const { return std::max(std::abs(low_[axis]), std::abs(high_[axis])); }

  // Adds the smallest w of a part and its distance to the near plane z = -w; spread(v) is how far v . p goes below its
  // value at the centre. Returns w at the centre.
  template <class Spread>
  double add_depths(const glm::dvec3& center, Spread spread) {
    const double w = at(w_, center);
    const double smallest_w = w - spread(glm::dvec3(w_));
    const double before_near = at(z_ + w_, center) - spread(glm::dvec3(z_ + w_));
    // The comparison is negated so that NaN is not trusted; infinite corners make one of these numbers NaN or infinite.
    if (!(smallest_w > 0.0 && smallest_w < std::numeric_limits<double>::infinity() && before_near >= 0.0))
      trusted_ = false;
    smallest_w_ = std::min(smallest_w_, smallest_w);
    smallest_before_near_ = std::min(smallest_before_near_, before_near);
    largest_coordinate_ = glm::max(largest_coordinate_, glm::abs(center));
    return w;
  }

  // Adds a shape that is the unit ball of the inner product `dot`, scaled by `radius` r around `center` c: a plane n .
  // p + d = 0 touches it iff (n . c + d)^2 = r^2 dot(n, n).
  template <class Dot>
  void add_round(const glm::dvec3& center, double radius, Dot dot) {
    const double w =
        add_depths(center, [&](const glm::dvec3& v) { return radius * std::sqrt(std::max(dot(v, v), 0.0)); });
    if (!(radius >= 0.0)) trusted_ = false;
    if (!trusted_) return;
    largest_coordinate_ = glm::max(largest_coordinate_, glm::abs(center) + radius);
    add_silhouette(0, first_, center, radius, w, dot);
    add_silhouette(1, second_, center, radius, w, dot);
  }

  // The planes through the eye with x = s w touch the shape where (X - s W)^2 = r^2 |a - s b|^2, a quadratic equation
  // for the two ends s of the range of x / w. Here a, b are the directions of the rows for x and w, and X, W their
  // values at the centre.
  template <class Dot>
  void add_silhouette(int axis, const glm::dvec4& row, const glm::dvec3& center, double radius, double w, Dot dot) {
    const glm::dvec3 a(row);
    const glm::dvec3 b(w_);
    const double x = at(row, center);
    const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b);
    const double rr = radius * radius;
    const glm::dvec3 across = x * b - w * a;
    // The root's argument is not negative where w > r |b|, except for rounding.
    const double root = radius * std::sqrt(std::max(dot(across, across) - rr * (aa * bb - ab * ab), 0.0));
    const double middle = x * w - rr * ab;
    const double lead = w * w - rr * bb;  // > 0 when the whole shape has w > 0
    if (!(lead > 0.0)) {
      trusted_ = false;
      return;
    }
    const double inverse = 1.0 / lead;
    add_range(axis, (middle - root) * inverse, (middle + root) * inverse);
  }

  void add_range(int axis, double low, double high) {
    low_[axis] = std::min(low_[axis], low);
    high_[axis] = std::max(high_[axis], high);
    if (!(low <= high)) trusted_ = false;
  }

  glm::dvec4 x_, y_, z_, w_;  // rows of object_to_clip
  bool orthographic_;
  glm::dvec2 size_;
  glm::dvec4 first_, second_;
  glm::dvec2 low_{std::numeric_limits<double>::infinity()};
  glm::dvec2 high_{-std::numeric_limits<double>::infinity()};
  glm::dvec3 largest_coordinate_{0.0};
  double smallest_w_ = std::numeric_limits<double>::infinity();
  double smallest_before_near_ = std::numeric_limits<double>::infinity();  // z + w
  bool trusted_ = true;
};

struct AddShape {
  Extent& extent;

  void operator()(const Sphere& sphere) const { extent.add_sphere(sphere.center, sphere.radius); }
  void operator()(const Box& box) const {
    for (int i = 0; i < 8; ++i) extent.add_point(corner(box, i));
  }
  // A cylinder is the convex hull of its two end discs.
  void operator()(const Cylinder& cylinder) const {
    const glm::dvec3 axis(cylinder.axis);
    for (const float t : {cylinder.t_min, cylinder.t_max})
      extent.add_disc(glm::dvec3(cylinder.center) + double{t} * axis, cylinder.radius, axis);
  }
  void operator()(const PointHull& hull) const {
    for (const glm::vec3& p : hull.points) extent.add_point(p);
  }
};

}  // namespace

std::optional<ScreenBounds> screen_bounds(const View& view, const ObjectView& object, const VisibilityQuery& query) {
  Extent extent(view, object, false);
  std::visit(AddShape{extent}, query.shape);
  return extent.result();
}

Diagonals screen_diagonals(const View& view, const ObjectView& object, const VisibilityQuery& query) {
  Extent extent(view, object, true);
  std::visit(AddShape{extent}, query.shape);
  return extent.diagonals();
}

}  // namespace occlod
