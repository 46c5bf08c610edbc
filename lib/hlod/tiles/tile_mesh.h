// The edges at which a mesh ends.
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

// By vertex: the first vertex at the same position. O(n log n).
[[nodiscard]] std::vector<std::uint32_t> first_at_position(std::span<const glm::vec3> positions);

// An edge that one triangle uses, as it is wound.
struct BorderEdge {
  std::uint32_t from;
  std::uint32_t to;
  std::uint32_t triangle;
};

// Of positions, not of vertices: at seams between wedges there is no border. `first`: of first_at_position(). By
// triangle. O(n log n).
[[nodiscard]] std::vector<BorderEdge> border_edges(std::span<const Triangle> triangles,
                                                   std::span<const std::uint32_t> first);

// By vertex: the sum of the doubled area vectors of the triangles at its position; zero for all but the first there.
[[nodiscard]] std::vector<glm::dvec3> area_sums(std::span<const glm::vec3> positions,
                                                std::span<const Triangle> triangles,
                                                std::span<const std::uint32_t> first);

// What the nodes of level 0 have in common along their borders. Borders of coarser nodes run along the same vertices.

struct BorderVertex {
  glm::vec3 position{0.0F};
  glm::vec3 normal{0.0F};           // the mean over all triangles of level 0 there, by area; zero where that is
  bool is_at_input_border = false;  // an edge of level 0 that ends here is used by one triangle
};

class BorderVertices {
 public:
  // None.
  BorderVertices() = default;
  // Of all nodes of level 0, which are required. Calls `next` before each. Throws Error when a mapped file is damaged.
  // O(n log n).
  BorderVertices(const hlod::Hlod& hlod, const std::function<void()>& next);

  // Null where no border of a node of level 0 runs through `position`. O(log n).
  [[nodiscard]] const BorderVertex* at(const glm::vec3& position) const;

 private:
  std::vector<BorderVertex> vertices_;  // by position
};

// What one tile shows.

// A vertex for each set of attributes: what is drawn are `triangles`, wherever vertices lie. Object space.
struct TileMesh {
  TriangleMesh mesh;                // without wedges
  std::size_t skirt_triangles = 0;  // the last of them
};

[[nodiscard]] std::vector<Triangle> triangles_of(const hlod::NodeMesh& mesh);

// The mesh of node n, which has been required, with normals: where it has none, those of crease_normals(), and at
// borders with other nodes theirs too. Triangles with two corners at one place are left out where normals are made. It
// has as many materials as the HLOD, which say nothing.
[[nodiscard]] TileMesh tile_mesh(const hlod::Hlod& hlod, hlod::NodeId n, double crease_deg,
                                 const BorderVertices& borders);

// Hangs strips of a depth from all edges that one triangle of the tile uses, but for those at the input's border.
void add_skirts(TileMesh& tile, double depth, const BorderVertices& borders);

}  // namespace occlod::tiles
