// What one tile shows.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

#include "occlod/hlod/hlod.h"
#include "occlod/mesh/triangle_mesh.h"
#include "hlod/tiles/border_vertices.h"

namespace occlod::tiles {

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
