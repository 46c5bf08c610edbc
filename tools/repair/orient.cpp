#include "repair/orient.h"

#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>

#include <cstdint>
#include <utility>

#include "occlod/mesh.h"

namespace occlod::repair {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;

// CGAL copies the visitor, hence pointers.
struct Recorder : pmp::Default_orientation_visitor {
  std::vector<bool>* turned;       // per triangle
  std::vector<VertexId>* sources;  // per point

  void polygon_orientation_reversed(std::size_t triangle) const { (*turned)[triangle] = true; }
  void duplicated_vertex(std::size_t original, std::size_t /*copy*/) const { sources->push_back((*sources)[original]); }
};

// Counts edges that two triangles run through in the same direction after orienting: no direction is right for them.
std::size_t count_unorientable(const Soup& soup, std::size_t vertices) {
  TriangleMesh uncut;
  uncut.positions.resize(vertices);
  for (const Corners& t : soup.triangles)
    uncut.triangles.emplace_back(soup.sources[t[0]], soup.sources[t[1]], soup.sources[t[2]]);
  MeshReport report;
  count_topology(uncut, report);
  return report.inconsistent_edges;
}

// CGAL follows the first triangle of each piece. This turns back the pieces of which that turned more than half.
std::size_t follow_the_majority(HalfedgeMesh& mesh, const std::vector<bool>& turned) {
  auto piece_of = mesh.add_property_map<Face, std::size_t>("f:piece").first;
  const std::size_t pieces = pmp::connected_components(mesh, piece_of);
  std::vector<std::size_t> sizes(pieces), turns(pieces);
  for (const Face f : mesh.faces()) {
    ++sizes[piece_of[f]];
    turns[piece_of[f]] += turned[f];
  }
  std::vector<Face> back;
  for (const Face f : mesh.faces()) {
    const std::size_t piece = piece_of[f];
    if (2 * turns[piece] > sizes[piece]) back.push_back(f);
  }
  pmp::reverse_face_orientations(back, mesh);
  std::size_t total = 0;
  for (std::size_t piece = 0; piece < pieces; ++piece) total += std::min(turns[piece], sizes[piece] - turns[piece]);
  mesh.remove_property_map(piece_of);
  return total;
}

}  // namespace

HalfedgeMesh oriented_mesh(Soup soup, RepairCounts& counts) {
  const std::size_t vertices = soup.points.size();
  std::vector<bool> turned(soup.triangles.size());
  Recorder recorder;
  recorder.turned = &turned;
  recorder.sources = &soup.sources;
  pmp::orient_polygon_soup(soup.points, soup.triangles, CGAL::parameters::visitor(recorder));
  counts.vertices_duplicated = soup.points.size() - vertices;
  counts.unorientable_edges = count_unorientable(soup, vertices);
  HalfedgeMesh mesh = halfedge_mesh_of(soup);
  counts.triangles_turned = follow_the_majority(mesh, turned);
  counts.edges_stitched = pmp::stitch_borders(mesh);
  return mesh;
}

}  // namespace occlod::repair
