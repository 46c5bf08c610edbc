// Textured meshes to simplify: real ones, and generated ones with texture atlases in pieces.
#pragma once

#include <string>
#include <vector>

#include "occlod/mesh.h"

namespace occlod::bench {

// cylinder: 256 x 128 cells with bumps, one seam, the texture wound once around it. fragmented: the rough planet of
// level 6 (32,768 triangles) with a chart for each triangle. charts: the same in 1,000 charts. Otherwise a file in a
// folder of OCCLOD_MESHES. Clean, without normals and colours; throws Error.
[[nodiscard]] TriangleMesh load_textured_mesh(const std::string& name);

// Those that are generated or found; of the others a line on standard error.
[[nodiscard]] std::vector<std::string> available_textured(const std::vector<std::string>& names);

// The mesh without all but positions and triangles.
[[nodiscard]] TriangleMesh geometry_of(const TriangleMesh& mesh);

}  // namespace occlod::bench
