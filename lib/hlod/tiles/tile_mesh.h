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
  glm::vec3 normal{0.0F};  // area-weighted mean over all triangles of level 0 there; zero where that mean is zero
  bool is_at_input_border = false;  // one triangle alone uses an edge of level 0 that ends here
};

class BorderVertices {
 public:
  // Has no vertices.
  BorderVertices() = default;
  // Collects them from all nodes of level 0, which are required. Calls `next` before each node. Throws Error when a
  // mapped file is damaged. O(n log n).
  BorderVertices(const hlod::Hlod& hlod, const std::function<void()>& next);

  // Returns null where no border of a node of level 0 runs through `position`. O(log n).
  [[nodiscard]] const BorderVertex* at(const glm::vec3& position) const;

 private:
  std::vector<BorderVertex> vertices_;  // ordered by position
};

// An image that a tile holds itself.
struct OwnImage {
  std::vector<std::uint8_t> bytes;        // PNG or JPEG; empty: the tile has none
  std::vector<std::uint8_t> is_shown_by;  // by material: it shows this image, in place of the HLOD's
};

// Holds the mesh of a tile, with a vertex for each set of attributes. `triangles` are drawn whatever vertices coincide.
// Object space.
struct TileMesh {
  TriangleMesh mesh;                // without wedges
  std::size_t skirt_triangles = 0;  // number of skirt triangles, which come last
  OwnImage image = {};              // as materials of the mesh have it
};

[[nodiscard]] std::vector<Triangle> triangles_of(const hlod::NodeMesh& mesh);

// Returns the mesh of node n, which has been required, with normals. If the node has none, they are those of
// crease_normals(), joined with those of other nodes at borders, and triangles with two corners at one place are left
// out. Its materials are as many as those of the HLOD, but empty.
[[nodiscard]] TileMesh tile_mesh(const hlod::Hlod& hlod, hlod::NodeId n, double crease_deg,
                                 const BorderVertices& borders);

// Hangs strips of `depth` (object units) from all edges that one triangle of the tile uses, except at the input's
// border.
void add_skirts(TileMesh& tile, double depth, const BorderVertices& borders);

}  // namespace occlod::tiles
