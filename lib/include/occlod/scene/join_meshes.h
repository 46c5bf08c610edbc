// Several meshes at their places as one mesh.
#pragma once

#include <filesystem>
#include <glm/mat4x4.hpp>
#include <span>
#include <string>

#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// One mesh and where it stands.
struct PlacedMesh {
  const TriangleMesh* mesh = nullptr;  // valid, see TriangleMesh; must outlive the call
  glm::dmat4 object_to_world{1.0};     // affine, invertible
  std::string source_name;             // its file or generator: names of images start in the file's folder, and meshes
                                       // of one name share their materials
};

// All of them as one in world space, vertices and wedges apart as they were: triangles of mirrored objects are turned
// round, so that outsides stay outside. Normals and colours are kept when every mesh has them, texture coordinates and
// materials when any has: the others lie at (0, 0) and are plain. Names of images become relative to `folder`, where
// the result is to be written, or absolute where they lie elsewhere. Throws Error that says `name` when all together
// have 2^32 wedges or more, or more than 65,535 materials or textures. O(size of all).
[[nodiscard]] TriangleMesh join_meshes(std::span<const PlacedMesh> meshes, const std::filesystem::path& folder,
                                       const std::string& name);

}  // namespace occlod
