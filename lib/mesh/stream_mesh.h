// Reads mesh files that are too large for memory and cuts meshes into pieces.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "base/memory.h"
#include "mesh/polygon_soup.h"
#include "occlod/mesh.h"

namespace occlod {

// The arrays of a mesh, wherever they are stored. Attributes are empty or one per wedge.
struct MeshArrays {
  std::span<const glm::vec3> positions;  // one per wedge
  std::span<const glm::vec3> normals;
  std::span<const glm::u8vec4> colors;
  std::span<const glm::vec2> texture_coordinates;
  std::span<const Triangle> triangles;             // indices of wedges
  std::span<const MaterialId> triangle_materials;  // empty or one per triangle
  TextureOrigin texture_origin = TextureOrigin::bottom_left;
  glm::dvec3 origin{0.0};  // of positions
  UpAxis up = UpAxis::z;
  std::span<const FeatureId> triangle_features = {};  // empty or one per triangle
};

[[nodiscard]] inline MeshArrays arrays_of(const TriangleMesh& mesh) {
  return {mesh.positions,
          mesh.normals,
          mesh.colors,
          mesh.texture_coordinates,
          mesh.wedge_triangles(),
          mesh.triangle_materials,
          mesh.texture_origin,
          mesh.origin,
          mesh.up,
          mesh.triangle_features};
}

class PieceCutter {
 public:
  // The arrays of `mesh` outlive it.
  explicit PieceCutter(const MeshArrays& mesh) : mesh_(mesh), local_(mesh.positions.size(), no_id) {}

  // Returns a run of triangles with the wedges that they use as vertices, in the order of their first use, without
  // materials, textures and names of features.
  [[nodiscard]] TriangleMesh cut(std::size_t begin, std::size_t end);

 private:
  MeshArrays mesh_;
  LargeVector<VertexId> local_;  // vertex in the current piece, by wedge
  std::vector<WedgeId> wedges_;
};

// True when the file has a format that a StreamedMesh reads: PLY or OBJ, by its extension.
[[nodiscard]] bool is_streamable(const std::filesystem::path& path);

// Reads what read_mesh() reads from a PLY or OBJ file, block by block into arrays that are stored in scratch files
// while a MemoryLimit lives.
class StreamedMesh {
 public:
  // `progress` may be empty. Throws Error as read_mesh() does.
  StreamedMesh(const std::filesystem::path& path, const std::function<void(double)>& progress);

  // Gives all triangles with three different corners in the order of the file, in pieces of at most `most` triangles.
  // Vertices with equal positions are not welded yet. Each piece has all materials, textures and names of
  // features.
  void visit(std::size_t most, const std::function<void(const TriangleMesh& piece)>& take) const;
  // Returns the counts of reading that read_mesh() reports, and its unreferenced and nonfinite vertices.
  [[nodiscard]] const MeshReport& report() const { return report_; }
  // Returns the origin of all pieces.
  [[nodiscard]] const glm::dvec3& origin() const { return soup_.origin; }

 private:
  void check_distances(const FileErrors& errors) const;
  void drop_repeated_corners(const FileErrors& errors);
  void count_unused_vertices();
  void repair_texture_coordinates();
  void repair_normals();
  [[nodiscard]] bool has_repeated_corner(const Triangle& t) const;

  ScratchSoup soup_;  // without its polygons
  LargeVector<Triangle> triangles_;
  MeshReport report_;
  LargeVector<bool> is_used_;  // by vertex; true when a triangle of the file uses it
};

}  // namespace occlod
