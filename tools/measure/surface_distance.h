// Samples the distance between two triangle surfaces with CGAL's AABB tree (under the GPL: tools and benchmarks only).
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>

#include "occlod/mesh.h"

namespace occlod::measure {

// Prepares a surface to measure from and to; keeps views of its arrays. Triangles without area are lines and points. It
// needs at least one triangle and finite positions. Building is O(n log n); memory is about 120 bytes per triangle.
class Surface {
 public:
  Surface(std::span<const glm::vec3> positions, std::span<const Triangle> triangles);
  ~Surface();
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;

  [[nodiscard]] std::span<const glm::vec3> positions() const noexcept { return positions_; }
  [[nodiscard]] std::span<const Triangle> triangles() const noexcept { return triangles_; }
  [[nodiscard]] double diagonal() const noexcept { return diagonal_; }  // of the box around all triangles
  // Returns the distance to the nearest point of the surface. Expected O(log n).
  [[nodiscard]] double distance_to(const glm::dvec3& point) const;

 private:
  struct Tree;
  std::span<const glm::vec3> positions_;
  std::span<const Triangle> triangles_;
  double diagonal_;
  std::unique_ptr<Tree> tree_;
};

struct SampleOptions {
  std::size_t samples = 200'000;  // points on each surface, stratified by area
  std::uint64_t seed = 1;
};

// Holds the distance from one surface to the other. All lengths are object units; rounding alone makes up to about
// 1e-14 of the size.
struct OneWayDistance {
  double rms = 0.0;        // root mean square over the samples
  double max = 0.0;        // over the samples and all vertices that triangles use: a lower bound of the true maximum
  glm::dvec3 max_at{0.0};  // the point of the first surface with this distance
};

struct SurfaceDistance {
  OneWayDistance a_to_b;
  OneWayDistance b_to_a;

  [[nodiscard]] double rms() const noexcept;
  [[nodiscard]] const OneWayDistance& farther() const noexcept;  // direction with the larger maximum
};

// The same surfaces and options give the same numbers. If no triangle of a surface has an area, all have equal weight.
[[nodiscard]] OneWayDistance one_way_distance(const Surface& from, const Surface& to, const SampleOptions& options);
[[nodiscard]] SurfaceDistance surface_distance(const Surface& a, const Surface& b, const SampleOptions& options = {});

}  // namespace occlod::measure
