// Writes a mesh as PLY (little endian), OBJ, OFF or STL (binary).
#pragma once

#include <filesystem>

#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// The extension decides the format, whatever its case. Writes beside `path` and renames, so that a failure leaves the
// old file as it was. Normals and colours are written where the format has them (PLY). Throws Error that names the
// file. O(n).
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

// Throws what write_mesh() would throw for this name and writes nothing: for programs that compute for long before.
void check_mesh_output(const std::filesystem::path& path);

}  // namespace occlod
