// Reads PLY (ascii, little and big endian), OBJ, OFF, STL (ascii, binary) and glTF (text, binary) into a plain indexed
// mesh.
#pragma once

#include <filesystem>
#include <functional>

#include "occlod/mesh/clean.h"

namespace occlod {

// Reads and cleans (mesh/clean.h). The extension decides the format, whatever its case. Polygons are cut into
// triangles: convex ones as fans, others by ear clipping in their plane. Throws Error that names the file, the line or
// element and the remedy for anything missing, empty, truncated, malformed or not finite. Expected O(n) time; memory is
// a small multiple of the file's size. `progress` is called now and then with the share of the file that has been read,
// in [0, 1], and with 1 before cleaning; what it throws ends the reading.
[[nodiscard]] CleanMesh read_mesh(const std::filesystem::path& path, const std::function<void(double)>& progress = {});

}  // namespace occlod
