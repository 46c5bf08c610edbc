// The slow and exact answer to "is any of this bound in front of the occluder?".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <optional>
#include <span>
#include <vector>

#include "occlod/visibility.h"
#include "oracle/bound_rays.h"
#include "oracle/ray_scene.h"

namespace occlod::test {

// What rays through one bound find. Its samples are the points where rays through pixel centres enter it, and points of
// it that the caller gives: each is compared with the occluder at the centre of the pixel that it is in.
struct Sight {
  std::uint32_t covered = 0;  // pixel centres inside the bound's outline
  std::uint32_t samples = 0;  // on the screen
  std::uint32_t visible = 0;  // of these, in front of the occluder or on it
  bool at_eye = false;        // some point is not beyond the near plane

  [[nodiscard]] bool hidden() const { return samples > 0 && visible == 0 && !at_eye; }
};

// A view, where its objects are, and an occluder among them. Depth is the distance from the eye along the axis.
class RayOracle {
 public:
  RayOracle(const View& view, std::span<const glm::dmat4> object_to_world, std::span<const OccluderPart> parts);

  // O(pixels of the bound's rectangle).
  [[nodiscard]] Sight look(const VisibilityQuery& bound, std::span<const glm::dvec3> points = {}) const;
  // Some sample is visible however a rasteriser may have rounded the occluder, or is not beyond the near plane.
  // O(triangles) for each visible sample.
  [[nodiscard]] bool certainly_visible(const VisibilityQuery& bound, std::span<const glm::dvec3> points = {}) const;
  // Nothing is between the eye and the point: along its own ray, not that of its pixel's centre.
  [[nodiscard]] bool is_seen(std::uint32_t object, const glm::dvec3& point) const;

  // Of the occluder at the pixel's centre; infinite where there is none.
  [[nodiscard]] double depth(int x, int y) const { return depths_[index(x, y)]; }
  // The smallest that a rasteriser can have drawn there: see ray_oracle.cpp.
  [[nodiscard]] double nearest_drawn(int x, int y) const;

 private:
  // (pixels from the image's middle times depth, depth), where rays start at the origin; or, where rays are parallel,
  // (pixels from the image's middle, depth). Linear in object space.
  struct Space {
    glm::dmat3 linear, inverse;
    glm::dvec3 offset;
  };
  struct Sample {
    int x, y;
    double depth;
  };

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  // Parameters of rays are depths.
  [[nodiscard]] Ray ray(double x, double y) const {
    const glm::dvec3 at(x - width_ / 2.0, y - height_ / 2.0, 0.0), ahead(0.0, 0.0, 1.0);
    return parallel_ ? Ray{at, ahead} : Ray{glm::dvec3(0.0), at + ahead};
  }
  // What pixels from the middle are multiplied with at this depth.
  [[nodiscard]] double spread(double depth) const { return parallel_ ? 1.0 : depth; }
  [[nodiscard]] std::optional<Sample> sample_at(const Space& space, const glm::dvec3& point) const;
  template <class Visit>
  bool any_sample(const VisibilityQuery& bound, std::span<const glm::dvec3> points, Visit visit) const;
  [[nodiscard]] double smallest_depth(const VisibilityQuery& bound) const;

  int width_, height_;
  double near_, range_;
  bool parallel_;
  std::vector<Space> spaces_;
  std::vector<std::array<glm::dvec3, 3>> occluder_;
  std::optional<RayScene> rays_;
  std::vector<double> depths_;
};

}  // namespace occlod::test
