// Makes the mesh of a tile from that of a node: normals across borders, and skirts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/hlod.h"
#include "occlod/mesh.h"

namespace occlod::tiles {

// Returns, per vertex, the first vertex at the same position. O(n log n).
[[nodiscard]] std::vector<std::uint32_t> first_at_position(std::span<const glm::vec3> positions);

// Describes an edge that one triangle uses, in the direction of its winding.
struct BorderEdge {
  std::uint32_t from;
  std::uint32_t to;
  std::uint32_t triangle;
};

// Returns the edges that only one triangle uses, ordered by triangle. Edges connect positions, not vertices, so seams
// between wedges are not borders. `first` is the result of first_at_position(). O(n log n).
[[nodiscard]] std::vector<BorderEdge> border_edges(std::span<const Triangle> triangles,
                                                   std::span<const std::uint32_t> first);

// Returns, per vertex, the sum of the doubled area vectors of the triangles at its position; zero for all but the first
// vertex there.
[[nodiscard]] std::vector<glm::dvec3> area_sums(std::span<const glm::vec3> positions,
                                                std::span<const Triangle> triangles,
                                                std::span<const std::uint32_t> first);

// Describes a vertex on the border of a node of level 0. Borders of coarser nodes run along the same vertices.
struct BorderVertex {
  glm::vec3 position{0.0F};
  std::uint32_t first_normal = 0, normal_count = 0;  // for BorderVertices::normals()
  bool is_at_input_border = false;                   // one triangle alone uses an edge of level 0 that ends here
};

// Surfaces that meet at up to this angle look smooth where the input has no normals.
inline constexpr double crease_deg = 60.0;

class BorderVertices {
 public:
  // Has no vertices.
  BorderVertices() = default;
  // Collects them from all nodes of level 0, which are required. Calls `next` before each node. Throws Error when a
  // mapped file is damaged. O(n log n).
  BorderVertices(const hlod::Hlod& hlod, const std::function<void()>& next);

  // Returns null where no border of a node of level 0 runs through `position`. O(log n).
  [[nodiscard]] const BorderVertex* at(const glm::vec3& position) const;
  // Returns the normals at a vertex: area-weighted means over triangles of level 0, in whatever nodes. Those that face
  // within crease_deg of each other have one normal, directly or through others.
  [[nodiscard]] std::span<const glm::vec3> normals(const BorderVertex& vertex) const {
    return std::span(normals_).subspan(vertex.first_normal, vertex.normal_count);
  }

 private:
  std::vector<BorderVertex> vertices_;  // ordered by position
  std::vector<glm::vec3> normals_;      // vertex by vertex
};

// An image that a tile holds itself.
struct OwnImage {
  std::vector<std::uint8_t> bytes;        // PNG or JPEG; empty: the tile has none
  std::vector<std::uint8_t> is_shown_by;  // by material: it shows this image, in place of the HLOD's
};

// Holds the mesh of a tile, with a vertex for each set of attributes. `triangles` are drawn whatever vertices coincide.
// Object space.
struct TileMesh {
  TriangleMesh mesh;                     // without wedges
  std::size_t skirt_triangles = 0;       // number of skirt triangles, which come last
  OwnImage image = {};                   // as materials of the mesh have it
  std::vector<FeatureId> features = {};  // those of the HLOD, ascending, by feature of the mesh; not all may be left
};

[[nodiscard]] std::vector<Triangle> triangles_of(const hlod::NodeMesh& mesh);

// Returns the mesh of node n, which has been required, with normals. Its texture coordinates lead to the image that the
// node has in the HLOD, where it has one. If the node has none, they are those of
// crease_normals() at crease_deg, joined with those of other nodes at borders, and triangles with two corners at one
// place are left out. Its materials are as many as those of the HLOD, but empty. Vertices are parted by feature, too,
// and features have no names.
[[nodiscard]] TileMesh tile_mesh(const hlod::Hlod& hlod, hlod::NodeId n, const BorderVertices& borders);

// Hangs strips of `depth` (object units) from all edges that one triangle of the tile uses, except at the input's
// border.
void add_skirts(TileMesh& tile, double depth, const BorderVertices& borders);

}  // namespace occlod::tiles
