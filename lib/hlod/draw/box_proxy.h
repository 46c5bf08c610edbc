// Computes the boxes that devices draw, slightly grown, to query whether nodes are visible: the same on every device.
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "occlod/bounds.h"
#include "occlod/view.h"
#include "raster/depth_tiles.h"

namespace occlod {

// Returns the matrix from object space to clip space with exact depths for depth buffers. ObjectView's own matrix is
// single-precision: close to the eye and far from the object's origin, its rows for z and w cancel, each with an error
// of 2^-24 of what cancels. Then z / w is off by many steps of a depth buffer, differently for each object. Here z is
// computed from w as z = a w + b, so the relative error of a depth is at most that of w. An orthographic z is kept: it
// is off by 2^-24 of the distance from the object's origin.
[[nodiscard]] inline glm::dmat4 clip_matrix(const Camera& camera, const ObjectView& object) {
  const double a = (camera.far + camera.near) / (camera.far - camera.near);
  const double b = -2.0 * camera.far * camera.near / (camera.far - camera.near);
  glm::dmat4 matrix(object.object_to_clip());
  if (object.is_orthographic()) return matrix;
  for (int column = 0; column < 4; ++column) matrix[column].z = a * matrix[column].w;
  matrix[3].z += b;
  return matrix;
}

[[nodiscard]] inline std::vector<glm::dmat4> clip_matrices(const Camera& camera, std::span<const ObjectView> objects) {
  std::vector<glm::dmat4> matrices;
  matrices.reserve(objects.size());
  for (const ObjectView& object : objects) matrices.push_back(clip_matrix(camera, object));
  return matrices;
}

enum class ProxyShape { sphere, box, cylinder };

// Describes the view's image and the smaller target that proxies are drawn into. One sample of the target stands for
// divisor x divisor pixels; the last column and row may stand for fewer.
struct Screen {
  Screen() = default;
  explicit Screen(const View& view, int target_divisor = 1);
  [[nodiscard]] int target_width() const noexcept { return (width + divisor - 1) / divisor; }
  [[nodiscard]] int target_height() const noexcept { return (height + divisor - 1) / divisor; }

  int width = 0;   // pixels
  int height = 0;  // pixels
  int divisor = 1;
  double slack_px = 0.0;  // that bounds are grown by beyond what is needed
  double focal_length_px = 0.0;
  double depth_range = 0.0;  // world units, from the near to the far plane
  bool orthographic = false;
};

// Holds one object's view in double precision, with the quantities for growing a bound by pixels.
struct ProxySpace {
  // `to_clip` is the matrix of clip_matrix().
  ProxySpace(const Screen& screen, const glm::dmat4& to_clip, bool is_mirrored);

  glm::dmat4 object_to_clip;
  // The ellipsoid of steps, in object units, that move a point where w = 1 by at most one pixel across or along the
  // line of sight is the image of the unit ball under this matrix. It extends length(row(d)) along the unit vector d,
  // and never more than `reach`.
  glm::dmat3 object_from_pixels;
  double reach = 0.0;
  bool mirrored = false;
};

// Describes a bound as the image center + directions * (half * u) of the points u of a unit shape.
struct Placement {
  ProxyShape shape = ProxyShape::box;
  glm::dvec3 center{0.0};
  glm::dmat3 directions{1.0};  // orthonormal, right-handed
  glm::dvec3 half{0.0};        // object units, >= 0
};

// Returns nothing for boxes that are not finite or are inside out.
[[nodiscard]] std::optional<Placement> place_box(const Box& box);
// Returns the placement grown so that it covers the sample of every pixel that it touches, at no greater depth than
// where it touches the pixel.
[[nodiscard]] Placement grown(const Placement& placement, const Screen& screen, const ProxySpace& space);

// Describes the grown box that every device draws for a queried box, however it counts pixels.
struct BoxProxy {
  enum class Kind {
    beside,     // touches no pixel: before the near plane or beside the image; counts 0
    drawn,      // the fields below are set
    uncertain,  // not finite, inside out, crosses the near plane, or reaches farther than 65,536 pixels from the middle
                // of the image; counts all pixels of the image
  };
  Kind kind = Kind::uncertain;

  glm::dmat4 unit_to_clip{1.0};  // from the cube [-1, 1]^3; not inverted for mirrored objects
  raster::ProjectedBox image;    // its corners in pixels and nearness
  glm::dvec2 min{0.0};           // smallest coordinates of the corners, pixels
  glm::dvec2 max{0.0};           // largest coordinates of the corners, pixels
};

// Returns the space of one object in a view, with the matrix of clip_matrix().
[[nodiscard]] ProxySpace proxy_space(const Screen& screen, const View& view, const ObjectView& object);

// Returns the proxy of a box in object space, grown() so that it covers the sample of every pixel in which anything
// inside the box can be visible. O(1).
[[nodiscard]] BoxProxy project_box(const Screen& screen, const ProxySpace& space, const Box& box);

// Returns the number of pixels that the proxy covers on an empty screen, which is what a query would count there.
// `outline` is scratch memory. O(rows covered).
[[nodiscard]] std::uint32_t covered_pixels(const Screen& screen, const BoxProxy& proxy, raster::BoxOutline& outline);

}  // namespace occlod
