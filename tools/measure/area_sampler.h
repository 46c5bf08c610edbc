// Spreads points evenly over the area of a triangle mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <random>
#include <span>
#include <vector>

#include "occlod/mesh.h"

namespace occlod::measure {

// Names a point of a surface by the corner weights of one of its triangles.
struct SurfacePoint {
  std::uint32_t triangle = 0;
  glm::dvec3 weights{1.0, 0.0, 0.0};  // at least 0, with sum 1 up to rounding
};

// Interpolates values at the corners of a triangle.
template <typename Value>
[[nodiscard]] Value at(const glm::dvec3& weights, const Value& a, const Value& b, const Value& c) {
  return weights.x * a + weights.y * b + weights.z * c;
}

// If no triangle has an area, all have equal weight.
class AreaSampler {
 public:
  // Keeps views of both arrays; needs at least one triangle. O(triangles).
  AreaSampler(std::span<const glm::vec3> positions, std::span<const Triangle> triangles);

  // Visits one point in each of `count` strata of equal area, which run through the triangles in order. The same seed
  // gives the same points with every C++ library.
  template <class Visit>
  void visit(std::size_t count, std::uint64_t seed, const Visit& visit_point) const {
    std::mt19937_64 random(seed);
    SurfacePoint point;
    double end = areas_[0];  // sum of the areas up to and including the point's triangle
    for (std::size_t i = 0; i < count; ++i) {
      const double target = total_ * ((static_cast<double>(i) + next_unit(random)) / static_cast<double>(count));
      while (end <= target && point.triangle + 1 < areas_.size()) end += areas_[++point.triangle];
      point.weights = weights_in(random);
      visit_point(point);
    }
  }

  // Returns the position in object space.
  [[nodiscard]] glm::dvec3 position(const SurfacePoint& point) const;
  // Returns the area of all triangles.
  [[nodiscard]] double area() const noexcept { return total_ / 2.0; }

 private:
  static double next_unit(std::mt19937_64& random);
  static glm::dvec3 weights_in(std::mt19937_64& random);

  std::span<const glm::vec3> positions_;
  std::span<const Triangle> triangles_;
  std::vector<double> areas_;  // doubled
  double total_ = 0.0;
};

}  // namespace occlod::measure
