// A triangle on the screen, to interpolate what belongs to its corners.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "occlod/view/view.h"

namespace occlod::picture {

// The three edge functions of a triangle in homogeneous pixel coordinates (Olano & Greer 1997): linear over the image
// and valid for triangles that reach behind the eye. Their ratios are perspective-correct barycentric coordinates.
class ScreenTriangle {
 public:
  // In world space.
  ScreenTriangle(const std::array<glm::dvec3, 3>& corners, const View& view);

  [[nodiscard]] glm::vec3 barycentric(const glm::dvec2& pixel) const;
  // The same beyond the triangle's edges too, and not rounded. The triangle must have an area on the screen.
  [[nodiscard]] glm::dvec3 exact_barycentric(const glm::dvec2& pixel) const;

  // How much they change a pixel; axis 0: across, 1: down.
  [[nodiscard]] glm::dvec3 barycentric_step(const glm::dvec2& pixel, int axis) const;

  // From the pixel to the nearest edge.
  [[nodiscard]] double edge_distance_px(const glm::dvec2& pixel) const;

  // Of the inscribed circle; infinite when the triangle reaches behind the eye.
  [[nodiscard]] double diameter_px() const { return diameter_px_; }

 private:
  // Of the edge functions.
  [[nodiscard]] glm::dvec3 at(const glm::dvec2& pixel) const;

  std::array<glm::dvec3, 3> edges_;
  double diameter_px_;
};

}  // namespace occlod::picture
