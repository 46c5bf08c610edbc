// Reads and writes mesh files: PLY (ascii, little and big endian), OBJ, OFF, STL (ascii, binary) and glTF (text,
// binary).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "occlod/generate.h"
#include "occlod/mesh.h"

namespace occlod {

// Reads a mesh and cleans it with clean(). The extension decides the format, in upper or lower case. Polygons are cut
// into triangles: convex ones as fans, others by ear clipping in their plane. Coordinates that floats would move by
// more than a millionth of the mesh's largest side become relative to TriangleMesh::origin. Throws Error that names the
// file, the line or element and the remedy for anything missing, empty, truncated, malformed or not finite. Expected
// O(n) time; memory is a small multiple of the file's size. `progress` is called from time to time with the share of
// the file that has been read, in [0, 1], and with 1 before cleaning; an exception that it throws ends the reading.
// `threads` is as for clean().
[[nodiscard]] CleanMesh read_mesh(const std::filesystem::path& path, const std::function<void(double)>& progress = {},
                                  int threads = 0);

// Writes a mesh as PLY (little endian), OBJ, GLB, OFF or STL (binary). The extension decides the format, in upper or
// lower case. Writes beside `path` and renames, so that a failure leaves the old file as it was. Everything that the
// format supports is written: in OBJ normals, texture coordinates, materials (in a file PATH.mtl beside it) and colours
// without alpha; in PLY normals, colours, texture coordinates and names of textures; in GLB everything, with triangles
// sorted by material. Reading restores the wedges. When the format has another texture origin than the mesh, v is
// written as 1 - v. With an origin coordinates are doubles in PLY, have all their digits in OBJ and OFF, and GLB has a
// node at the origin; STL holds floats only, so its coordinates stay relative to the origin, which its header names.
// Throws Error that names the file. O(n).
//
// Names of images are relative to `image_folder`, or to the folder of `path`. GLB holds the images, those of files too;
// beside OBJ and PLY those that the mesh holds become files, and names of others lead to where they are. Returns a line
// for each image that is not there, whose name is written as it is, for each that glTF lacks, such as TGA, which is
// left out of a GLB file, and for materials of which OBJ or PLY lose something: MTL has base colour, roughness,
// metallic and emission, and maps of base colour, emission and normals; PLY has textures of base colours only.
std::vector<std::string> write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);
// Writes it with the images of a folder.
std::vector<std::string> write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh,
                                    const std::filesystem::path& image_folder);

// Passes a mesh without attributes to `visit` in parts, the same parts at each call.
using MeshParts = std::function<void(const PartVisitor& visit)>;

// Counts what has been written.
struct WrittenCounts {
  std::uint64_t vertices = 0;   // in the file
  std::uint64_t triangles = 0;  // of all parts
};

// Writes the same file as write_mesh() for a mesh that is never whole in memory, as PLY or OBJ. `parts` is called twice
// for OBJ and three times for PLY, whose header has the counts. Throws Error as write_mesh() does, for other formats,
// and for 2^32 or more vertices. O(n).
WrittenCounts write_mesh_parts(const std::filesystem::path& path, const MeshParts& parts);

// Throws what write_mesh_parts() would throw for this path, and writes nothing.
void check_mesh_parts_output(const std::filesystem::path& path);

// Throws what write_mesh() would throw for this path, and writes nothing, so that a long computation can fail before it
// starts.
void check_mesh_output(const std::filesystem::path& path);

}  // namespace occlod
