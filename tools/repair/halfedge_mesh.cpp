#include "repair/halfedge_mesh.h"

#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>

#include <numeric>

namespace occlod::repair {
namespace {

const char* const sources_name = "v:source";

}  // namespace

Soup soup_of(const TriangleMesh& mesh) {
  Soup soup;
  soup.points.reserve(mesh.vertex_count());
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const glm::vec3& p = mesh.positions[v];
    soup.points.emplace_back(p.x, p.y, p.z);
  }
  soup.sources.resize(mesh.vertex_count());
  std::iota(soup.sources.begin(), soup.sources.end(), VertexId{0});
  soup.triangles.reserve(mesh.triangle_count());
  for (const Triangle& t : mesh.triangles) soup.triangles.push_back({t.x, t.y, t.z});
  return soup;
}

HalfedgeMesh halfedge_mesh_of(const Soup& soup) {
  HalfedgeMesh mesh;
  CGAL::Polygon_mesh_processing::polygon_soup_to_polygon_mesh(soup.points, soup.triangles, mesh);
  Sources sources = mesh.add_property_map<Vertex, VertexId>(sources_name).first;
  for (const Vertex v : mesh.vertices()) sources[v] = soup.sources[v];
  return mesh;
}

TriangleMesh triangle_mesh_of(HalfedgeMesh mesh, const TriangleMesh& original, std::vector<VertexId>& vertex_sources) {
  const Sources sources = mesh.add_property_map<Vertex, VertexId>(sources_name).first;  // finds the existing one
  TriangleMesh result;
  std::vector<VertexId> new_id(mesh.number_of_vertices() + mesh.number_of_removed_vertices(), no_id);
  const auto take = [&](Vertex v) {
    if (new_id[v] == no_id) {
      new_id[v] = static_cast<VertexId>(result.vertex_count());
      result.positions.push_back(original.positions[sources[v]]);
      vertex_sources.push_back(sources[v]);
    }
    return new_id[v];
  };
  for (const Vertex v : mesh.vertices()) {
    if (!mesh.is_isolated(v)) take(v);
  }
  result.triangles.reserve(mesh.number_of_faces());
  for (const Face f : mesh.faces()) {
    const Halfedge h = mesh.halfedge(f);
    result.triangles.emplace_back(take(mesh.source(h)), take(mesh.target(h)), take(mesh.target(mesh.next(h))));
  }
  return result;
}

}  // namespace occlod::repair
