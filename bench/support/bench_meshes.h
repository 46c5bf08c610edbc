// The meshes that benchmarks run on: rough planets, and real ones where OCCLOD_MESHES has them.
#pragma once

#include <string>
#include <vector>

#include "occlod/mesh.h"

namespace occlod::bench {

// "planet:8" = the rough planet of level 8 and seed 1, otherwise a file, relative to a folder of OCCLOD_MESHES. Those
// that are not found are left out, each with a line on standard error.
[[nodiscard]] std::vector<std::string> available(const std::vector<std::string>& names);

// Throws Error.
[[nodiscard]] TriangleMesh load_bench_mesh(const std::string& name);

}  // namespace occlod::bench
