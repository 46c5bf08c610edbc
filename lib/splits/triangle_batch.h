// The distances of many points from one triangle, in single precision.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace occlod {

// Points as one array a coordinate, so that compilers vectorise the loops over them.
struct PointBatch {
  std::vector<float> x, y, z;

  [[nodiscard]] std::size_t size() const noexcept { return x.size(); }
  void resize(std::size_t count);
  void set(std::size_t i, const glm::vec3& p) { x[i] = p.x, y[i] = p.y, z[i] = p.z; }
};

class TriangleBatch {
 public:
  TriangleBatch(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);

  // For every point whose squared distance is less than `least` has for it: that, and `number` into `chosen`.
  void choose_nearer(const PointBatch& points, std::uint32_t number, float* least, std::uint32_t* chosen) const;
  [[nodiscard]] float squared_distance(const glm::vec3& point) const;
  // Of four points, a coordinate at a time.
  using Four = std::array<float, 4>;
  [[nodiscard]] Four squared_distances(const Four& x, const Four& y, const Four& z) const;
  // To be added to a distance so that it is an upper bound whatever was lost in rounding.
  [[nodiscard]] float rounding(float distance) const { return 2e-6F * (distance + longest_edge_); }

 private:
  struct Edge {
    glm::vec3 start;    // from origin_
    glm::vec3 along;    // to its end
    glm::vec3 inwards;  // in the plane, unit length; zero where the triangle has no inside to speak of
    float inverse_squared_length = 0.0F;
    float offset = 0.0F;  // added to the distance from the line: negative where there is no inside
  };
  [[nodiscard]] float squared_distance(float x, float y, float z) const;

  glm::vec3 origin_;
  glm::vec3 normal_;
  std::array<Edge, 3> edges_;
  float longest_edge_ = 0.0F;
};

}  // namespace occlod
