#include "area_sampler.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace occlod::measure {

AreaSampler::AreaSampler(std::span<const glm::vec3> positions, std::span<const Triangle> triangles)
    : positions_(positions), triangles_(triangles) {
  areas_.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const glm::dvec3 a(positions[t.x]);
    areas_.push_back(glm::length(glm::cross(glm::dvec3(positions[t.y]) - a, glm::dvec3(positions[t.z]) - a)));
  }
  if (std::all_of(areas_.begin(), areas_.end(), [](double area) { return area <= 0.0; }))
    std::fill(areas_.begin(), areas_.end(), 1.0);
  for (double area : areas_) total_ += area;
}

glm::dvec3 AreaSampler::position(const SurfacePoint& point) const {
  const Triangle& t = triangles_[point.triangle];
  return at(point.weights, glm::dvec3(positions_[t.x]), glm::dvec3(positions_[t.y]), glm::dvec3(positions_[t.z]));
}

// Returns 53 random bits in [0, 1). std::uniform_real_distribution may differ between C++ libraries.
double AreaSampler::next_unit(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

// Returns a uniform point of the triangle: Turk, Generating Random Points in Triangles, Graphics Gems 1990.
glm::dvec3 AreaSampler::weights_in(std::mt19937_64& random) {
  const double s = std::sqrt(next_unit(random)), t = next_unit(random);
  return {1.0 - s, s * (1.0 - t), s * t};
}

}  // namespace occlod::measure
