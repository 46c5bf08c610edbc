#include "repair/fill_holes.h"

#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/boost/graph/iterator.h>

#include <iterator>
#include <vector>

namespace occlod::repair {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;

// Up to this many edges all triangulations of a border are tried, in cubic time. The best one does not depend on memory
// addresses, unlike the pieces of a Delaunay triangulation that are tried for longer borders.
constexpr std::size_t max_edges_for_cubic = 256;

bool is_single_triangle(Halfedge border, const HalfedgeMesh& mesh) {
  const auto face_inside = [&](Halfedge h) { return mesh.face(mesh.opposite(h)); };
  return face_inside(border) == face_inside(mesh.next(border)) && face_inside(border) == face_inside(mesh.prev(border));
}

std::size_t fill(Halfedge border, std::size_t edges, HalfedgeMesh& mesh) {
  std::vector<Face> patch;
  pmp::triangulate_hole(mesh, border, std::back_inserter(patch),
                        CGAL::parameters::use_delaunay_triangulation(edges > max_edges_for_cubic)
                            .do_not_use_cubic_algorithm(edges > max_edges_for_cubic));
  return patch.size();
}

}  // namespace

void fill_holes(HalfedgeMesh& mesh, std::size_t max_edges, const std::function<void(double)>& progress,
                RepairCounts& counts) {
  std::vector<Halfedge> borders;
  pmp::extract_boundary_cycles(mesh, std::back_inserter(borders));
  for (std::size_t i = 0; i < borders.size(); ++i) {
    const std::size_t edges = CGAL::halfedges_around_face(borders[i], mesh).size();
    std::size_t added = 0;
    if (edges <= max_edges && !is_single_triangle(borders[i], mesh)) {
      progress(static_cast<double>(i) / static_cast<double>(borders.size()));
      added = fill(borders[i], edges, mesh);
    }
    counts.triangles_added += added;
    ++(added > 0 ? counts.holes_filled : counts.borders_left);
  }
}

}  // namespace occlod::repair
