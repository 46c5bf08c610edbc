// The volumes that are drawn in place of bounds, and the cases that are decided without drawing. No OpenGL here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "occlod/refine/visibility.h"
#include "occlod/view/view.h"

namespace occlod::gl {

enum class ProxyShape { sphere, box, cylinder };
inline constexpr std::size_t proxy_shape_count = 3;

// Convex, closed, counter-clockwise seen from outside, circumscribed: contains the unit ball (32 triangles), the cube
// [-1, 1]^3 (12), or the cylinder of radius 1 around z in [-1, 1] (64). Symmetric about z = 0.
struct ProxyMesh {
  std::vector<glm::vec3> vertices;
  std::vector<std::uint16_t> indices;
};
[[nodiscard]] const ProxyMesh& unit_proxy(ProxyShape shape);

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

struct ProxyDraw {
  ProxyShape shape = ProxyShape::box;
  glm::mat4 unit_to_clip{1.0F};   // of the target; front faces are counter-clockwise, also for mirrored objects
  std::uint32_t most_pixels = 0;  // of the view that the proxy can cover
};

// What to do about one query: draw, or answer at once.
struct QueryPlan {
  std::optional<ProxyDraw> draw;
  bool visible = true;  // the answer when nothing is drawn
};

// Nothing for bounds that are not finite or inside out.
[[nodiscard]] std::optional<Placement> place(const VisibilityQuery& query);
// Grows the placement so that it covers the sample of every pixel that it touches, at no greater depth than where it
// touches it.
[[nodiscard]] Placement grown(const Placement& placement, const Screen& screen, const ProxySpace& space);
[[nodiscard]] QueryPlan plan_query(const Screen& screen, const ProxySpace& space, const VisibilityQuery& query);

}  // namespace occlod::gl
