#include "splits/triangle_batch.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace occlod {

void PointBatch::resize(std::size_t count) {
  x.resize(count);
  y.resize(count);
  z.resize(count);
}

// The frame is made in double precision, so that slivers have one as exact as others; only those whose normal is lost
// even then are taken for their edges, which are part of them.
TriangleBatch::TriangleBatch(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) : origin_(a) {
  const std::array<glm::dvec3, 3> corners = {glm::dvec3(0.0), glm::dvec3(b) - glm::dvec3(a),
                                             glm::dvec3(c) - glm::dvec3(a)};
  const glm::dvec3 area = glm::cross(corners[1], corners[2]);
  const double twice_area = glm::length(area);
  double longest2 = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 edge = corners[(i + 1) % 3] - corners[i];
    longest2 = std::max(longest2, glm::dot(edge, edge));
  }
  longest_edge_ = static_cast<float>(std::sqrt(longest2));
  const bool has_inside = twice_area > 1e-6 * longest2;
  const glm::dvec3 normal = has_inside ? area / twice_area : glm::dvec3(0.0);
  normal_ = glm::vec3(normal);
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 along = corners[(i + 1) % 3] - corners[i];
    const double length2 = glm::dot(along, along);
    const double length = std::sqrt(length2);
    edges_[i] = {glm::vec3(corners[i]), glm::vec3(along),
                 has_inside ? glm::vec3(glm::cross(normal, along) / length) : glm::vec3(0.0F),
                 length2 > 1e-30 ? static_cast<float>(1.0 / length2) : 0.0F, has_inside ? 0.0F : -1.0F};
  }
}

// Every choice is a select of values that are there anyway: a loop over this has no branch.
inline float TriangleBatch::squared_distance(float x, float y, float z) const {
  x -= origin_.x;
  y -= origin_.y;
  z -= origin_.z;
  const auto least = [](float a, float b) { return a < b ? a : b; };
  const auto most = [](float a, float b) { return a > b ? a : b; };
  const auto depth = [&](const Edge& e) {
    return e.inwards.x * (x - e.start.x) + e.inwards.y * (y - e.start.y) + e.inwards.z * (z - e.start.z) + e.offset;
  };
  const auto squared_distance_to = [&](const Edge& e) {
    const float px = x - e.start.x, py = y - e.start.y, pz = z - e.start.z;
    const float along = (e.along.x * px + e.along.y * py + e.along.z * pz) * e.inverse_squared_length;
    const float t = least(most(along, 0.0F), 1.0F);
    const float dx = px - t * e.along.x, dy = py - t * e.along.y, dz = pz - t * e.along.z;
    return dx * dx + dy * dy + dz * dz;
  };
  const float height = normal_.x * x + normal_.y * y + normal_.z * z;
  const float height2 = height * height;
  const float inside = least(least(depth(edges_[0]), depth(edges_[1])), depth(edges_[2]));
  const float outside2 =
      least(least(squared_distance_to(edges_[0]), squared_distance_to(edges_[1])), squared_distance_to(edges_[2]));
  return inside >= 0.0F ? height2 : outside2;
}

// In runs: distances first, then choices, so that each loop is simple enough to be vectorised.
void TriangleBatch::choose_nearer(const PointBatch& points, std::uint32_t number, float* __restrict least,
                                  std::uint32_t* __restrict chosen) const {
  constexpr std::size_t run = 256;
  std::array<float, run> squares;
  const TriangleBatch triangle = *this;  // a local: nothing that is written can be part of it
  for (std::size_t begin = 0; begin < points.size(); begin += run) {
    const float* const x = points.x.data() + begin;
    const float* const y = points.y.data() + begin;
    const float* const z = points.z.data() + begin;
    const std::size_t count = std::min(run, points.size() - begin);
    for (std::size_t i = 0; i < count; ++i) squares[i] = triangle.squared_distance(x[i], y[i], z[i]);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t nearer = squares[i] < least[begin + i] ? ~0U : 0U;
      chosen[begin + i] = (number & nearer) | (chosen[begin + i] & ~nearer);
      least[begin + i] = squares[i] < least[begin + i] ? squares[i] : least[begin + i];
    }
  }
}

TriangleBatch::Four TriangleBatch::squared_distances(const Four& x, const Four& y, const Four& z) const {
  Four squares;
  for (std::size_t i = 0; i < 4; ++i) squares[i] = squared_distance(x[i], y[i], z[i]);
  return squares;
}

float TriangleBatch::squared_distance(const glm::vec3& point) const {
  return squared_distance(point.x, point.y, point.z);
}

}  // namespace occlod
