#include "oracle/ray_oracle.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>
#include <limits>

namespace occlod::test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Rasterisers snap corners to 1/256 pixel, that is by up to 1/512 in x and in y. A point of the snapped triangle has
// the depth of the point with the same barycentric coordinates in the true one, which is no farther away than the
// corners have moved. So what is drawn at a pixel's centre is the depth of some point of the occluder in a square of
// 1/512 pixel around it; as much again is for the rounding of single-precision corners within 4,096 pixels of the
// middle.
constexpr double snapped_px = 1.0 / 256.0;

// Single-precision nearness and matrices: a few units of 2^-24 of a depth, or of the range of an orthographic view.
constexpr double depth_rounding = 1e-6;

// What is left of a convex polygon where `inside` is not negative. Linear functions only.
template <class Inside>
void clip(std::vector<glm::dvec3>& polygon, std::vector<glm::dvec3>& scratch, Inside inside) {
  scratch.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double at_a = inside(a), at_b = inside(b);
    if (at_a >= 0.0) scratch.push_back(a);
    if ((at_a < 0.0) != (at_b < 0.0)) scratch.push_back(glm::mix(a, b, at_a / (at_a - at_b)));
  }
  polygon.swap(scratch);
}

struct BoxAround {
  glm::dvec3 min, max;

  explicit BoxAround(const Sphere& s) : min(glm::dvec3(s.center) - double{s.radius}), max(min + 2.0 * s.radius) {}
  explicit BoxAround(const Box& b) : min(b.min), max(b.max) {}
  explicit BoxAround(const Cylinder& c) {
    const glm::dvec3 a = glm::dvec3(c.center) + double{c.t_min} * glm::dvec3(c.axis),
                     b = glm::dvec3(c.center) + double{c.t_max} * glm::dvec3(c.axis);
    min = glm::min(a, b) - double{c.radius};
    max = glm::max(a, b) + double{c.radius};
  }
  explicit BoxAround(const PointHull& hull) : min(infinity), max(-infinity) {
    for (const glm::vec3& p : hull.points) min = glm::min(min, glm::dvec3(p)), max = glm::max(max, glm::dvec3(p));
  }
};

// The smallest value of g . p over a bound.
struct Smallest {
  const glm::dvec3& g;

  double operator()(const Sphere& s) const { return glm::dot(g, glm::dvec3(s.center)) - s.radius * glm::length(g); }
  double operator()(const Box& b) const {
    const glm::dvec3 p = g * glm::dvec3(b.min), q = g * glm::dvec3(b.max);
    return std::min(p.x, q.x) + std::min(p.y, q.y) + std::min(p.z, q.z);
  }
  double operator()(const Cylinder& c) const {
    const glm::dvec3 axis(c.axis);
    const double along = glm::dot(g, axis);
    return glm::dot(g, glm::dvec3(c.center)) + std::min(c.t_min * along, c.t_max * along) -
           c.radius * glm::length(g - along * axis);
  }
  double operator()(const PointHull& hull) const {
    double smallest = infinity;
    for (const glm::vec3& p : hull.points) smallest = std::min(smallest, glm::dot(g, glm::dvec3(p)));
    return smallest;
  }
};

}  // namespace

RayOracle::RayOracle(const View& view, std::span<const glm::dmat4> object_to_world, std::span<const OccluderPart> parts)
    : width_(view.width()),
      height_(view.height()),
      near_(view.camera().near),
      range_(view.camera().far - near_),
      parallel_(view.is_orthographic()) {
  for (const glm::dmat4& to_world : object_to_world) {
    const glm::dmat4 to_clip = view.world_to_clip() * to_world;
    const glm::dvec4 x = glm::row(to_clip, 0) * (width_ / 2.0), y = glm::row(to_clip, 1) * (-height_ / 2.0),
                     // z from -1 to 1 is from the near to the far plane.
        depth = parallel_ ? glm::row(to_clip, 2) * (range_ / 2.0) + glm::dvec4(0, 0, 0, near_ + range_ / 2.0)
                          : glm::row(to_clip, 3);
    const glm::dmat3 linear = glm::transpose(glm::dmat3(glm::dvec3(x), glm::dvec3(y), glm::dvec3(depth)));
    spaces_.push_back({linear, glm::inverse(linear), {x.w, y.w, depth.w}});
  }
  std::vector<glm::vec3> positions;
  std::vector<Triangle> triangles;
  for (const OccluderPart& part : parts) {
    const Space& space = spaces_[part.object];
    for (const Triangle& t : part.triangles) {
      std::array<glm::dvec3, 3>& corners = occluder_.emplace_back();
      const auto first = static_cast<VertexId>(positions.size());
      for (int k = 0; k < 3; ++k)
        positions.emplace_back(corners[static_cast<std::size_t>(k)] =
                                   space.linear * glm::dvec3(part.positions[t[k]]) + space.offset);
      triangles.emplace_back(first, first + 1, first + 2);
    }
  }
  rays_.emplace(positions, triangles);
  depths_.resize(index(0, height_));
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const Ray at = ray(x + 0.5, y + 0.5);
      depths_[index(x, y)] = rays_->first_hit(at.origin, at.direction, near_);
    }
}

// `visit(sample)` until it says true.
template <class Visit>
bool RayOracle::any_sample(const VisibilityQuery& bound, std::span<const glm::dvec3> points, Visit visit) const {
  const Space& space = spaces_[bound.object];
  for (const glm::dvec3& p : points)
    if (const std::optional<Sample> sample = sample_at(space, p); sample && visit(*sample, false)) return true;
  // Every pixel centre inside the bound's outline.
  const BoxAround box = std::visit([](const auto& shape) { return BoxAround(shape); }, bound.shape);
  glm::dvec2 low(infinity), high(-infinity);
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 corner((i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                            (i & 4) != 0 ? box.max.z : box.min.z);
    const glm::dvec3 p = space.linear * corner + space.offset;
    if (!(p.z > 0.0)) {
      low = glm::dvec2(-infinity), high = glm::dvec2(infinity);
      break;
    }
    low = glm::min(low, glm::dvec2(p) / spread(p.z)), high = glm::max(high, glm::dvec2(p) / spread(p.z));
  }
  const glm::dvec2 middle = glm::dvec2(width_, height_) / 2.0, size(width_, height_);
  const glm::ivec2 first(glm::clamp(glm::floor(low + middle), glm::dvec2(0.0), size)),
      end(glm::clamp(glm::floor(high + middle) + 1.0, glm::dvec2(0.0), size));
  for (int y = first.y; y < end.y; ++y)
    for (int x = first.x; x < end.x; ++x) {
      const Ray at = ray(x + 0.5, y + 0.5);
      const RayRange range =
          range_inside({space.inverse * (at.origin - space.offset), space.inverse * at.direction}, bound);
      if (!range.empty() && range.end >= near_ && visit({x, y, std::max(range.begin, near_)}, true)) return true;
    }
  return false;
}

std::optional<RayOracle::Sample> RayOracle::sample_at(const Space& space, const glm::dvec3& point) const {
  const glm::dvec3 p = space.linear * point + space.offset;
  if (!(p.z >= near_)) return std::nullopt;
  const double x = std::floor(p.x / spread(p.z) + width_ / 2.0), y = std::floor(p.y / spread(p.z) + height_ / 2.0);
  if (!(x >= 0.0 && y >= 0.0 && x < width_ && y < height_)) return std::nullopt;
  return Sample{static_cast<int>(x), static_cast<int>(y), p.z};
}

double RayOracle::smallest_depth(const VisibilityQuery& bound) const {
  const Space& space = spaces_[bound.object];
  const glm::dvec3 gradient = glm::row(space.linear, 2);
  return std::visit(Smallest{gradient}, bound.shape) + space.offset.z;
}

Sight RayOracle::look(const VisibilityQuery& bound, std::span<const glm::dvec3> points) const {
  Sight sight;
  sight.at_eye = !(smallest_depth(bound) > near_);
  any_sample(bound, points, [&](const Sample& sample, bool centre) {
    ++sight.samples;
    sight.covered += centre ? 1U : 0U;
    sight.visible += sample.depth <= depth(sample.x, sample.y) ? 1U : 0U;
    return false;
  });
  return sight;
}

bool RayOracle::certainly_visible(const VisibilityQuery& bound, std::span<const glm::dvec3> points) const {
  if (smallest_depth(bound) < near_ * (1.0 - depth_rounding)) return true;
  return any_sample(bound, points, [&](const Sample& sample, bool) {
    const double not_nearer = sample.depth + depth_rounding * (parallel_ ? range_ : sample.depth);
    return not_nearer <= depth(sample.x, sample.y) && not_nearer <= nearest_drawn(sample.x, sample.y);
  });
}

bool RayOracle::is_seen(std::uint32_t object, const glm::dvec3& point) const {
  const Space& space = spaces_[object];
  if (!sample_at(space, point)) return false;
  const glm::dvec3 p = space.linear * point + space.offset;
  const Ray own = parallel_ ? Ray{{p.x, p.y, 0.0}, {0.0, 0.0, 1.0}} : Ray{glm::dvec3(0.0), p / p.z};
  return p.z <= rays_->first_hit(own.origin, own.direction, near_);
}

double RayOracle::nearest_drawn(int x, int y) const {
  const glm::dvec2 centre(x + 0.5 - width_ / 2.0, y + 0.5 - height_ / 2.0);
  double nearest = infinity;
  std::vector<glm::dvec3> polygon, scratch;
  for (const std::array<glm::dvec3, 3>& triangle : occluder_) {
    polygon.assign(triangle.begin(), triangle.end());
    clip(polygon, scratch, [&](const glm::dvec3& p) { return p.z - near_; });
    for (const int axis : {0, 1})
      for (const double side : {-1.0, 1.0})
        clip(polygon, scratch, [&](const glm::dvec3& p) {
          return side * (p[axis] - centre[axis] * spread(p.z)) + snapped_px * spread(p.z);
        });
    for (const glm::dvec3& p : polygon) nearest = std::min(nearest, p.z);
  }
  return nearest;
}

}  // namespace occlod::test
