// Reads PLY (ascii, little and big endian), OBJ, OFF, STL (ascii, binary) and glTF (text, binary) into a plain indexed
// mesh.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "occlod/generate.h"
#include "occlod/mesh.h"

namespace occlod {

// Reads and cleans (mesh/clean.h). The extension decides the format, whatever its case. Polygons are cut into
// triangles: convex ones as fans, others by ear clipping in their plane. Throws Error that names the file, the line or
// element and the remedy for anything missing, empty, truncated, malformed or not finite. Expected O(n) time; memory is
// a small multiple of the file's size. `progress` is called now and then with the share of the file that has been read,
// in [0, 1], and with 1 before cleaning; what it throws ends the reading. `threads` as for clean().
[[nodiscard]] CleanMesh read_mesh(const std::filesystem::path& path, const std::function<void(double)>& progress = {},
                                  int threads = 0);

// Writes a mesh as PLY (little endian), OBJ, GLB, OFF or STL (binary).

// The extension decides the format, whatever its case. Writes beside `path` and renames, so that a failure leaves the
// old file as it was. What a format has is written: OBJ has normals, texture coordinates, materials (in a file PATH.mtl
// beside it) and colours without alpha; PLY normals, colours, texture coordinates and names of textures; GLB all, its
// triangles sorted by material. Wedges are there again after reading. Where a format has its texture coordinates'
// origin elsewhere than the mesh, v is written as 1 - v. Names of textures are written as the mesh has them, relative
// to its own file; images that it holds stay inside GLB and are written as files beside OBJ and PLY. Throws Error that
// names the file. O(n).
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

// Gives a mesh without attributes in parts, the same each time.
using MeshParts = std::function<void(const PartVisitor& visit)>;

// What has been written.
struct WrittenCounts {
  std::uint64_t vertices = 0;   // in the file
  std::uint64_t triangles = 0;  // of all parts
};

// The same file for a mesh that is never whole in memory, as PLY or OBJ: `parts` is called twice for OBJ and three
// times for PLY, whose header has the counts. Throws Error as write_mesh() does, for another format, and for 2^32 or
// more vertices. O(n).
WrittenCounts write_mesh_parts(const std::filesystem::path& path, const MeshParts& parts);

// Throws what write_mesh_parts() would throw for this name and writes nothing.
void check_mesh_parts_output(const std::filesystem::path& path);

// Throws what write_mesh() would throw for this name and writes nothing: for programs that compute for long before.
void check_mesh_output(const std::filesystem::path& path);

}  // namespace occlod
