// An HLOD in which tests break one thing at a time.
#pragma once

#include "occlod/build_hlod.h"
#include "support/meshes.h"

namespace occlod::hlod::test {

[[nodiscard]] inline TriangleMesh good_mesh() { return occlod::test::noisy_sphere(5, 2); }

// Of that mesh, of several levels, with splits within nodes.
[[nodiscard]] inline const Hlod& good() {
  static const Hlod hlod = [] {
    HlodBuildOptions options;
    options.node_triangles = 64;
    options.within = Within::splits;
    return build_hlod(good_mesh(), options);
  }();
  return hlod;
}

// A node with parents and children.
[[nodiscard]] inline NodeId inner_node() { return good().data().levels[1].first_node; }

}  // namespace occlod::hlod::test
