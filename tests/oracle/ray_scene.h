// Rays against triangles.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "occlod/base.h"
#include "occlod/mesh.h"

namespace occlod::test {

// Embree finds the triangle, in single precision and watertight (RTC_SCENE_FLAG_ROBUST): no ray slips through an edge
// that two triangles share. The distance is then computed anew, in double precision.
class RayScene {
 public:
  RayScene(std::span<const glm::vec3> positions, std::span<const Triangle> triangles);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  // The smallest t >= t_min for which origin + t direction is on a triangle, seen from either side; infinite where none
  // is. Which triangle that is may be wrong where two are closer to each other, or an edge to the ray, than 2^-20 of
  // the distance.
  [[nodiscard]] double first_hit(const glm::dvec3& origin, const glm::dvec3& direction, double t_min = 0.0) const;

  struct Hit {
    std::uint32_t triangle = no_id;  // none
    float t = 0.0F;                  // origin + t direction is on it, give or take rounding
  };
  // The same with t >= 0 as Embree finds it, in single precision: for many rays.
  [[nodiscard]] Hit first_triangle(const glm::vec3& origin, const glm::vec3& direction) const;

 private:
  class Embree;
  std::vector<glm::vec3> positions_;
  std::vector<Triangle> triangles_;
  std::unique_ptr<Embree> embree_;
};

}  // namespace occlod::test
