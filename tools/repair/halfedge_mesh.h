// Wraps CGAL's half-edge mesh, with the vertices that it was made of.
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <array>
#include <cstddef>
#include <vector>

#include "occlod/mesh.h"

namespace occlod::repair {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;  // floats as doubles: predicates on them are exact
using HalfedgeMesh = CGAL::Surface_mesh<Point>;
using Vertex = HalfedgeMesh::Vertex_index;
using Halfedge = HalfedgeMesh::Halfedge_index;
using Face = HalfedgeMesh::Face_index;
using Corners = std::array<std::size_t, 3>;

// Holds a triangle soup as CGAL wants it.
struct Soup {
  std::vector<Point> points;
  std::vector<VertexId> sources;  // per point, the vertex that it is a copy of
  std::vector<Corners> triangles;
};

using Sources = HalfedgeMesh::Property_map<Vertex, VertexId>;

[[nodiscard]] Soup soup_of(const TriangleMesh& mesh);

// Makes a mesh whose face i is triangle i and vertex i is point i. The soup must be a consistently oriented manifold.
[[nodiscard]] HalfedgeMesh halfedge_mesh_of(const Soup& soup);

// Returns the triangles, with the positions of `original` that their vertices come from, which are appended to
// `vertex_sources`. Unused vertices are left out.
[[nodiscard]] TriangleMesh triangle_mesh_of(HalfedgeMesh mesh, const TriangleMesh& original,
                                            std::vector<VertexId>& vertex_sources);

}  // namespace occlod::repair
