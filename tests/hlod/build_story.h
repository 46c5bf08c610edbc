// What a build of an HLOD does, the same with every call.
#pragma once

#include <functional>
#include <utility>

#include "occlod/build_hlod.h"
#include "occlod/mesh.h"

namespace occlod::hlod {

struct Story {
  const char* name;
  TriangleMesh mesh;
  HlodBuildOptions options;
};

// Returns a build of many small nodes, with options that `set` changes.
inline Story story(const char* name, TriangleMesh mesh, const std::function<void(HlodBuildOptions&)>& set = {}) {
  HlodBuildOptions options;
  options.node_triangles = 16;
  if (set) set(options);
  return {name, std::move(mesh), options};
}

}  // namespace occlod::hlod
