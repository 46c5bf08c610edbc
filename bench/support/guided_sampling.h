// Guided visibility sampling (Wonka, Wimmer, Zhou, Maierhofer, Hesina and Reshetov 2006): the triangles that rays from
// a cell of space hit, found by random rays and by mutations of those that found something.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "base/arithmetic.h"
#include "occlod/cell_builder.h"
#include "oracle/ray_scene.h"

namespace occlod::bench {

struct GuidedOptions {
  bool guided = true;    // false: random rays only
  double max_ms = 60e3;  // processor time of this thread
  std::uint64_t max_rays = ~std::uint64_t{0};
  double border_rad = 1e-3;  // how far outside a triangle's border it is sampled, as seen from the start of the ray
  double finest_rad = 2e-3;  // parts of this border that look shorter are not divided
  double jump = 0.01;        // share of the distance by which a hit has to be nearer than the border to hide it
  std::uint64_t seed = 1;
};

struct FoundTriangle {
  std::uint32_t triangle = 0;
  std::uint64_t rays = 0;  // that had been shot
  double ms = 0.0;         // since the beginning; read every 256 rays
};

// One cell. Rays see both sides of triangles.
class GuidedSampling {
 public:
  // `scene`: of these triangles. All outlive it. `cell` has a volume.
  GuidedSampling(std::span<const glm::vec3> positions, std::span<const Triangle> triangles, const test::RayScene& scene,
                 const CellBox& cell, const GuidedOptions& options);

  // Goes on until time or rays are up. In the order in which they were found.
  std::span<const FoundTriangle> run();
  [[nodiscard]] std::uint64_t rays() const { return rays_; }

 private:
  using Hit = test::RayScene::Hit;
  struct Sample {
    glm::vec3 start, point;  // of a ray, and on the triangle that it found
    std::uint32_t triangle = 0;
  };
  struct BorderPoint {
    glm::vec3 place;
    Hit hit;
  };

  Hit shoot(const glm::vec3& start, const glm::vec3& towards);
  void shoot_at_random();
  void sample_border(const Sample& sample);
  BorderPoint look_at(const Sample& sample, const glm::vec3& place);
  void divide(const Sample& sample, const BorderPoint& a, const BorderPoint& b);
  void look_past(const Sample& sample, const glm::vec3& hidden, std::uint32_t occluder);
  void look_back(const glm::vec3& hidden, const glm::vec3& past);
  void read_clock();

  std::span<const glm::vec3> positions_;
  std::span<const Triangle> triangles_;
  const test::RayScene& scene_;
  glm::vec3 low_, high_;  // of the cell
  GuidedOptions options_;
  RandomStream random_;
  std::vector<bool> is_found_;
  std::vector<FoundTriangle> found_;
  std::deque<Sample> queue_;
  std::uint64_t rays_ = 0;
  std::size_t timed_ = 0;  // of found_
  double start_ms_ = 0.0, ms_ = 0.0;
};

}  // namespace occlod::bench
