// Does `occlod hlod build --clusters N INPUT... -o FILE.glb`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "occlod/build_hierarchy.h"
#include "progress.h"

namespace occlod::tool {

struct ClusterJob {
  std::vector<std::string> inputs;
  std::string output;
  std::uint32_t max_triangles = 0;
  ErrorBound error_bound = ErrorBound::accumulated;
  bool compresses = false;
  int threads = 0;
};

// Builds, writes, and prints what was made.
void build_clusters(const ClusterJob& job, Progress& progress, bool json);

}  // namespace occlod::tool
