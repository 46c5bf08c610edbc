// Random meshes, transforms and cameras of the kinds that rounding is hard on. The same seed gives the same.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <random>

#include "occlod/mesh.h"
#include "occlod/view.h"

namespace occlod::test {

class HardViews {
 public:
  explicit HardViews(std::uint64_t seed) : random_(seed) {}

  [[nodiscard]] double between(double low, double high);
  [[nodiscard]] std::size_t below(std::size_t count) { return static_cast<std::size_t>(random_() % count); }
  [[nodiscard]] glm::dvec3 direction();  // unit

  // Spheres, needles, soups and sheets, from tiny to huge, at the origin or up to a million of their sizes away.
  [[nodiscard]] TriangleMesh mesh();
  // Turned; often scaled, unevenly or mirrored; often far from the origin.
  [[nodiscard]] glm::dmat4 transform();
  // The eye far away, in the bounds, on a vertex or hardly above a triangle; any angle, shape of image and range, among
  // them planes through a vertex.
  [[nodiscard]] Camera camera(const TriangleMesh& mesh, const glm::dmat4& object_to_world);

 private:
  [[nodiscard]] double power_of_ten(double least, double most);
  [[nodiscard]] bool chance(double p) { return between(0.0, 1.0) < p; }

  std::mt19937_64 random_;
};

}  // namespace occlod::test
