// Mesh files that are too large for memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "base/large_vector.h"
#include "mesh/polygon_soup.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// Whether the file has a format that a StreamedMesh reads: PLY or OBJ, by its extension.
[[nodiscard]] bool is_streamable(const std::filesystem::path& path);

// What read_mesh() reads from a PLY or OBJ file, block by block into arrays, which lie in scratch files while a
// MemoryLimit lives.
class StreamedMesh {
 public:
  // `progress` may be empty. Throws Error as read_mesh() does.
  StreamedMesh(const std::filesystem::path& path, const std::function<void(double)>& progress);

  // Gives all triangles with three different corners in the order of the file, in pieces of `most` or fewer. Vertices
  // at one position are not one yet. Each piece has all materials and textures.
  void visit(std::size_t most, const std::function<void(const TriangleMesh& piece)>& take) const;

 private:
  void check_distances(const FileErrors& errors) const;
  void drop_repeated_corners(const FileErrors& errors);
  void repair_texture_coordinates();
  void repair_normals();
  [[nodiscard]] bool has_repeated_corner(const Triangle& t) const;

  ScratchSoup soup_;  // but for its polygons
  LargeVector<Triangle> triangles_;
  LargeVector<bool> is_used_;  // by vertex: by a triangle of the file
};

}  // namespace occlod
