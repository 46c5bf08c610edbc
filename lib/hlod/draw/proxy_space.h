// Boxes and other bounds in object space, and how far they are grown before they are drawn in place of what they hold:
// the same for every device.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "occlod/math/bounds.h"
#include "occlod/view/view.h"

namespace occlod {

enum class ProxyShape { sphere, box, cylinder };

// The view's image and the smaller one that proxies are drawn into: one sample for divisor x divisor pixels, the last
// column and row for what is left of them.
struct Screen {
  Screen() = default;
  explicit Screen(const View& view, int target_divisor = 1);
  [[nodiscard]] int target_width() const noexcept { return (width + divisor - 1) / divisor; }
  [[nodiscard]] int target_height() const noexcept { return (height + divisor - 1) / divisor; }

  int width = 0;   // pixels
  int height = 0;  // pixels
  int divisor = 1;
  double focal_length_px = 0.0;
  double depth_range = 0.0;  // world units, from the near to the far plane
  bool orthographic = false;
};

// One object's view in double precision, with what growing a bound by pixels needs.
struct ProxySpace {
  // to_clip: see clip_matrix.
  ProxySpace(const Screen& screen, const glm::dmat4& to_clip, bool is_mirrored);

  glm::dmat4 object_to_clip;
  // Object units that move a point where w = 1 by one pixel, in any direction across or along the line of sight: the
  // image of that unit ball reaches length(row(d)) along the unit vector d, and never more than reach.
  glm::dmat3 object_from_pixels;
  double reach = 0.0;
  bool mirrored = false;
};

// A bound as the image center + directions * (half * u) of a unit shape.
struct Placement {
  ProxyShape shape = ProxyShape::box;
  glm::dvec3 center{0.0};
  glm::dmat3 directions{1.0};  // orthonormal, right-handed
  glm::dvec3 half{0.0};        // object units, >= 0
};

// Nothing for boxes that are not finite or inside out.
[[nodiscard]] std::optional<Placement> place_box(const Box& box);
// Grows the placement so that it covers the sample of every pixel that it touches, at no greater depth than where it
// touches it.
[[nodiscard]] Placement grown(const Placement& placement, const Screen& screen, const ProxySpace& space);

}  // namespace occlod
