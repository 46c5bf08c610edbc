// CGAL's half-edge mesh with the way back to the vertices that it was made of.
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

// A triangle soup, as CGAL wants it.
struct Soup {
  std::vector<Point> points;
  std::vector<VertexId> sources;  // the vertex that each point is a copy of
  std::vector<Corners> triangles;
};

using Sources = HalfedgeMesh::Property_map<Vertex, VertexId>;

[[nodiscard]] Soup soup_of(const TriangleMesh& mesh);

// Face i is triangle i, vertex i is point i. The soup must be a manifold in one direction.
[[nodiscard]] HalfedgeMesh halfedge_mesh_of(const Soup& soup);

// The positions of `original` that the vertices come from, which are appended to `vertex_sources`, and the triangles;
// unused vertices are left out.
[[nodiscard]] TriangleMesh triangle_mesh_of(HalfedgeMesh mesh, const TriangleMesh& original,
                                            std::vector<VertexId>& vertex_sources);

}  // namespace occlod::repair
