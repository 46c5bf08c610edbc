#include "surface_distance.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "area_sampler.h"
#include "triangle_distance.h"

namespace occlod::measure {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using FaceId = std::uint32_t;  // into Arrays::triangles

glm::dvec3 to_glm(const Point& p) { return {p.x(), p.y(), p.z()}; }
Point to_cgal(const glm::dvec3& p) { return {p.x, p.y, p.z}; }

struct Arrays {
  std::span<const glm::vec3> positions;
  std::span<const Triangle> triangles;

  [[nodiscard]] glm::dvec3 corner(FaceId face, int i) const { return positions[triangles[face][i]]; }
};

// Models CGAL's concept AABBPrimitiveWithSharedData: a triangle by its index, with corners in our own arrays.
class IndexedTriangle {
 public:
  // The names are the concept's. NOLINTBEGIN(readability-identifier-naming)
  using Id = FaceId;
  using Point = Kernel::Point_3;
  using Datum = Kernel::Triangle_3;
  using Datum_reference = Datum;
  using Point_reference = Point;
  using Shared_data = Arrays;
  // NOLINTEND(readability-identifier-naming)

  IndexedTriangle(const Triangle* triangle, const Arrays& arrays)
      : id_(static_cast<FaceId>(triangle - arrays.triangles.data())) {}
  [[nodiscard]] Id id() const { return id_; }
  [[nodiscard]] Datum datum(const Arrays& arrays) const {
    return {to_cgal(arrays.corner(id_, 0)), to_cgal(arrays.corner(id_, 1)), to_cgal(arrays.corner(id_, 2))};
  }
  [[nodiscard]] Point reference_point(const Arrays& arrays) const { return to_cgal(arrays.corner(id_, 0)); }
  static Arrays construct_shared_data(const Arrays& arrays) { return arrays; }

 private:
  FaceId id_;
};

// Finds nearest points itself, because CGAL projects onto the supporting plane, which a triangle without area lacks.
class Traits : public CGAL::AABB_traits<Kernel, IndexedTriangle> {
 public:
  class NearestPoint {
   public:
    explicit NearestPoint(const Arrays& arrays) : arrays_(arrays) {}
    // Returns the nearest point of `triangle`, or `bound` if it is nearer.
    Point operator()(const Point& p, const IndexedTriangle& triangle, const Point& bound) const {
      const FaceId f = triangle.id();
      const Point nearest =
          to_cgal(nearest_point(to_glm(p), arrays_.corner(f, 0), arrays_.corner(f, 1), arrays_.corner(f, 2)));
      return CGAL::squared_distance(p, nearest) < CGAL::squared_distance(p, bound) ? nearest : bound;
    }

   private:
    const Arrays& arrays_;
  };

  [[nodiscard]] NearestPoint closest_point_object() const { return NearestPoint(shared_data()); }
};

template <class Visit>
void visit_used_vertices(const Surface& surface, const Visit& visit_point) {
  std::vector<char> visited(surface.positions().size(), 0);
  for (const Triangle& triangle : surface.triangles())
    for (int i = 0; i < 3; ++i)
      if (!std::exchange(visited[triangle[i]], 1)) visit_point(glm::dvec3(surface.positions()[triangle[i]]));
}

double diagonal_of(std::span<const glm::vec3> positions, std::span<const Triangle> triangles) {
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec3 high = -low;
  for (const Triangle& triangle : triangles) {
    for (int i = 0; i < 3; ++i) {
      low = glm::min(low, glm::dvec3(positions[triangle[i]]));
      high = glm::max(high, glm::dvec3(positions[triangle[i]]));
    }
  }
  return glm::distance(low, high);
}

}  // namespace

struct Surface::Tree : CGAL::AABB_tree<Traits> {};

Surface::Surface(std::span<const glm::vec3> positions, std::span<const Triangle> triangles)
    : positions_(positions),
      triangles_(triangles),
      diagonal_(diagonal_of(positions, triangles)),
      tree_(std::make_unique<Tree>()) {
  assert(!triangles.empty());
  tree_->insert(triangles.data(), triangles.data() + triangles.size(), Arrays{positions, triangles});
  tree_->build();
}

Surface::~Surface() = default;

double Surface::distance_to(const glm::dvec3& point) const {
  return glm::distance(point, to_glm(tree_->closest_point(to_cgal(point))));
}

double SurfaceDistance::rms() const noexcept { return std::max(a_to_b.rms, b_to_a.rms); }

const OneWayDistance& SurfaceDistance::farther() const noexcept { return a_to_b.max >= b_to_a.max ? a_to_b : b_to_a; }

OneWayDistance one_way_distance(const Surface& from, const Surface& to, const SampleOptions& options) {
  assert(options.samples > 0);
  OneWayDistance result;
  result.max = -1.0;
  const auto measure = [&](const glm::dvec3& point) {
    const double distance = to.distance_to(point);
    if (distance > result.max) result.max = distance, result.max_at = point;
    return distance;
  };
  double sum = 0.0;
  const AreaSampler sampler(from.positions(), from.triangles());
  sampler.visit(options.samples, options.seed, [&](const SurfacePoint& point) {
    const double distance = measure(sampler.position(point));
    sum += distance * distance;
  });
  result.rms = std::sqrt(sum / static_cast<double>(options.samples));
  visit_used_vertices(from, measure);
  return result;
}

SurfaceDistance surface_distance(const Surface& a, const Surface& b, const SampleOptions& options) {
  return {one_way_distance(a, b, options), one_way_distance(b, a, options)};
}

}  // namespace occlod::measure
