// bench_simplify_cgal MESH OUTPUT POLICY TRIANGLES: reduces a mesh by CGAL's edge collapse, and prints what that took
// as JSON. POLICY: lt, Lindstrom and Turk; gh, Garland and Heckbert, with the placement that CGAL's example bounds by
// normals.
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <string>
#include <vector>

#include "occlod/mesh_file.h"
#include "stopwatch.h"

namespace occlod::bench {
namespace {

namespace simplification = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Simple_cartesian<double>;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

// CGAL's own predicates count edges.
struct FewFaces {
  std::size_t most;
  template <typename Cost, typename Profile>
  bool operator()(const Cost& /*cost*/, const Profile& profile, std::size_t /*before*/, std::size_t /*now*/) const {
    return profile.surface_mesh().number_of_faces() <= most;
  }
};

// What a half-edge mesh cannot hold is taken apart, as CGAL's manual advises.
SurfaceMesh surface_of(const TriangleMesh& mesh) {
  std::vector<Kernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> faces;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    points.emplace_back(mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z);
  for (const Triangle& t : mesh.triangles) faces.push_back({t.x, t.y, t.z});
  namespace pmp = CGAL::Polygon_mesh_processing;
  if (!pmp::is_polygon_soup_a_polygon_mesh(faces)) {
    pmp::repair_polygon_soup(points, faces);
    pmp::orient_polygon_soup(points, faces);
  }
  SurfaceMesh surface;
  pmp::polygon_soup_to_polygon_mesh(points, faces, surface);
  return surface;
}

void reduce(SurfaceMesh& surface, const std::string& policy, std::size_t triangles) {
  const FewFaces stop{triangles};
  if (policy == "lt") {
    simplification::edge_collapse(surface, stop,
                                  CGAL::parameters::get_cost(simplification::LindstromTurk_cost<SurfaceMesh>())
                                      .get_placement(simplification::LindstromTurk_placement<SurfaceMesh>()));
    return;
  }
  using Policies = simplification::GarlandHeckbert_plane_policies<SurfaceMesh, Kernel>;
  const Policies policies(surface);
  const simplification::Bounded_normal_change_placement<Policies::Get_placement> placement(policies.get_placement());
  simplification::edge_collapse(surface, stop,
                                CGAL::parameters::get_cost(policies.get_cost()).get_placement(placement));
}

TriangleMesh mesh_of(SurfaceMesh& surface) {
  surface.collect_garbage();
  TriangleMesh mesh;
  for (const auto v : surface.vertices())
    mesh.positions.emplace_back(surface.point(v).x(), surface.point(v).y(), surface.point(v).z());
  for (const auto f : surface.faces()) {
    const auto h = surface.halfedge(f);
    mesh.triangles.emplace_back(surface.source(h), surface.target(h), surface.target(surface.next(h)));
  }
  return mesh;
}

void run(char** argv) {
  const TriangleMesh mesh = read_mesh(argv[1]).mesh;
  const std::string policy = argv[3];
  if (policy != "lt" && policy != "gh") throw std::runtime_error("no policy " + policy + ": lt or gh");
  const tool::Stopwatch stopwatch;
  const std::clock_t before = std::clock();
  SurfaceMesh surface = surface_of(mesh);
  reduce(surface, policy, std::strtoull(argv[4], nullptr, 10));
  const TriangleMesh reduced = mesh_of(surface);
  const double cpu_ms = 1e3 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  fmt::print("{{\"cpu_ms\": {}, \"wall_ms\": {}}}\n", cpu_ms, stopwatch.milliseconds());
  write_mesh(argv[2], reduced);
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) {
  try {
    if (argc != 5) throw std::runtime_error("usage: bench_simplify_cgal MESH OUTPUT lt|gh TRIANGLES");
    occlod::bench::run(argv);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_simplify_cgal: {}\n", error.what());
    return 1;
  }
}
