// How many fragments a mesh has in a view: what drawing it costs besides its triangles.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>

#include "occlod/mesh/triangle_mesh.h"
#include "occlod/view/view.h"

namespace occlod {

// Of a mesh, or of its front faces: those that occluders keep.
struct FragmentCount {
  double triangles = 0.0;
  double layers = 0.0;  // fragments for each pixel of the image: 1 where triangles cover it once

  FragmentCount& operator+=(const FragmentCount& o) {
    triangles += o.triangles;
    layers += o.layers;
    return *this;
  }
};

struct MeshFragments {
  FragmentCount all;
  FragmentCount front;
};

// From the areas of triangles in the image, clipped to it. Of every `step`-th of them, each of which stands for `step`;
// step >= 1. `two_sided`: all are fronts. Not finite corners count as triangles without fragments. O(triangles / step).
[[nodiscard]] MeshFragments count_fragments(std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                                            const ObjectView& view, bool two_sided, std::size_t step);

}  // namespace occlod
