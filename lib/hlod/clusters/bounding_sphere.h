// Small spheres around points and around spheres.
#pragma once

#include <span>

#include "occlod/bounds.h"

namespace occlod::hlod {

// Returns a sphere that holds all the spheres, at least one; points have radius 0. Its radius is within a few per cent
// of the least. Steps from the middle of their box towards the farthest one, less far each time (Badoiu and Clarkson
// 2003). O(n).
[[nodiscard]] Sphere sphere_around(std::span<const Sphere> spheres);

}  // namespace occlod::hlod
