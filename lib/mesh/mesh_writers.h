// The writers of formats with materials, which write_mesh() calls.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh/chunked_writer.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// Also writes PATH with the extension .mtl where the mesh has materials. `path`: of the mesh.
void write_obj(ChunkedWriter& out, const TriangleMesh& mesh, const std::filesystem::path& path);

// Throws Error that names `path` for a mesh of more than 4 GiB, which a GLB file cannot be.
void write_glb(ChunkedWriter& out, const TriangleMesh& mesh, const std::filesystem::path& path);

// The files of the textures, as a mesh at `path` names them. Images that the mesh holds are written beside it, as
// STEM_<number>.png or what they are.
[[nodiscard]] std::vector<std::string> texture_files(const TriangleMesh& mesh, const std::filesystem::path& path);

// Of an image's first bytes, where the mesh does not say it: image/png, image/jpeg or application/octet-stream.
[[nodiscard]] std::string mime_type_of(const Texture& texture);

// The second texture coordinate where the other origin counts from.
[[nodiscard]] inline float from_other_origin(float v) noexcept { return 1.0F - v; }

}  // namespace occlod
