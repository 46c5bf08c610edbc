// Simplifiers of textured meshes, each behind the same function.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "occlod/mesh.h"

namespace occlod::bench {

struct WedgeRun {
  TriangleMesh result;
  double milliseconds = 0.0;      // of simplifying alone; of the whole build where one serves all targets
  double bytes_per_vertex = 0.0;  // of the hierarchy; 0 without
};

struct WedgeSimplifier {
  std::string tool;     // what it is
  std::string variant;  // how it is set; may be empty
  // One run for each target, a number of triangles that the result should have at most.
  std::function<std::vector<WedgeRun>(const TriangleMesh& mesh, std::span<const std::size_t> targets)> simplify;
};

// One hierarchy on one thread, cut at each target. "geometry": of the positions alone, what textures cost in shape.
[[nodiscard]] std::vector<WedgeSimplifier> occlod_simplifiers();

// meshopt_simplify(), which keeps seams and ignores what lies between them; with version 0.20 or newer also
// meshopt_simplifyWithAttributes() by the weight of a step in the texture, in lengths on the surface, and the same
// with meshopt_SimplifyPermissive (0.25 or newer).
[[nodiscard]] std::vector<WedgeSimplifier> meshoptimizer_simplifiers();

// "0.18"; of the library that this was built with.
[[nodiscard]] std::string meshoptimizer_version();

}  // namespace occlod::bench
