// The error of a node on the screen.
#pragma once

#include <glm/vec3.hpp>

#include "occlod/hlod/hlod.h"
#include "occlod/view/view.h"

namespace occlod::hlod {

// An eye in object space, and how lengths of the object appear from there.
struct ScreenScale {
  glm::dvec3 eye{0.0};            // its place, object space; where rays are parallel, of no meaning
  double focal_length_px = 1.0;   // pixels that one world unit across the line of sight covers at distance 1, or
                                  // anywhere where rays are parallel
  double least_distance = 1e-30;  // > 0, world units: of the near plane
  // World units per object unit along each axis, or less: distances are measured with it. Exact unless the placement
  // shears.
  glm::dvec3 axis_stretch{1.0};
  double largest_stretch = 1.0;  // world units per object unit at most: errors are measured with it
  bool orthographic = false;     // rays are parallel: errors look the same at every distance
};

// Of an object in a view: `object` was made for `view`.
[[nodiscard]] ScreenScale screen_scale(const View& view, const ObjectView& object);

// World units from the eye to the nearest point of the box, or less where the placement shears; not for parallel rays.
[[nodiscard]] double distance_to(const Box& box, const ScreenScale& scale);

// Pixels that the node's error covers at most where the node is nearest to the eye: the larger of its own error at its
// box and its children's at its lod_box. No less than for any child of the node, seen from anywhere, so a front of
// nodes whose error is below a tolerance is legal as it is.
[[nodiscard]] double screen_error_px(const Node& node, const ScreenScale& scale);

// The same by the nearest point of the node's sphere, as published methods have it: coarser, and no less than for any
// child either.
[[nodiscard]] double sphere_error_px(const Node& node, const ScreenScale& scale);

// Pixels that Node::guaranteed_error covers at most: seen from the eye, no point of the node's triangles is farther
// from the input. By the nearest point of lod_box, so no less than for any child.
[[nodiscard]] double guaranteed_error_px(const Node& node, const ScreenScale& scale);

// As screen_error_px() of a node that is refined within as far as possible: what is left is its children's error, at
// its lod_box. No less than the error of any child, so on a front of nodes for which it is below a tolerance, those
// whose own error is not can be refined within.
[[nodiscard]] double least_screen_error_px(const Node& node, const ScreenScale& scale);
// Likewise, by the sphere.
[[nodiscard]] double least_sphere_error_px(const Node& node, const ScreenScale& scale);

// The error in object units that covers so many pixels where the node's box is nearest to the eye. For within_cut().
[[nodiscard]] double screen_error_limit(const Node& node, const ScreenScale& scale, double pixels);
// Likewise, of the sphere.
[[nodiscard]] double sphere_error_limit(const Node& node, const ScreenScale& scale, double pixels);

}  // namespace occlod::hlod
