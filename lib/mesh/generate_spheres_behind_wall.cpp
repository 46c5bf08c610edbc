#include <utility>

#include "base/option_checker.h"
#include "mesh/box_lattice.h"
#include "mesh/octahedron_lattice.h"
#include "mesh/part_giver.h"
#include "base/portable_math.h"
#include "occlod/mesh/generate.h"

namespace occlod {
namespace {

// The wall is [-thickness, 0] x [-1, 1]^2; the spheres stay within [-2.3, -0.2] x [-0.9, 0.9]^2, so an eye at x > 0
// that is inside the wall's square sees none of them.
constexpr double wall_thickness = 0.05;

void append_wall(TriangleMesh& mesh, int cells) {
  const BoxLattice lattice({1, cells, cells});
  lattice.for_each_point([&](glm::ivec3 p) {
    mesh.positions.emplace_back(wall_thickness * (p.x - 1), 2.0 * p.y / cells - 1.0, 2.0 * p.z / cells - 1.0);
  });
  lattice.append_triangles(0, mesh.triangles);
}

void append_sphere(TriangleMesh& mesh, const OctahedronLattice& lattice, RandomStream& random) {
  const auto first = static_cast<VertexId>(mesh.vertex_count());
  const double radius = random.between(0.04, 0.1);
  const double x = random.between(-2.2, -0.3);
  const double y = random.between(-0.8, 0.8);
  const double z = random.between(-0.8, 0.8);
  for (std::size_t ring = 0; ring < lattice.ring_count(); ++ring) {
    lattice.for_each_direction(ring, [&](const glm::dvec3& direction) {
      mesh.positions.emplace_back(glm::dvec3(x, y, z) + radius * direction);
    });
  }
  lattice.append_triangles(first, mesh.triangles);
}

void append_spheres_behind_wall(const SpheresBehindWallOptions& options, PartGiver& parts) {
  const OptionChecker check("spheres behind wall");
  check.in_range("spheres", options.spheres, 1, 1'000'000);
  check.in_range("level", options.level, 0, 8);
  check.in_range("wall_cells", options.wall_cells, 1, 4096);
  check.in_range("spheres * 4^level", static_cast<double>(options.spheres) * (1 << (2 * options.level)), 0.0, 1e8);

  RandomStream random(options.seed);
  append_wall(parts.part, options.wall_cells);
  const OctahedronLattice lattice(options.level);
  for (int sphere = 0; sphere < options.spheres; ++sphere) {
    append_sphere(parts.part, lattice, random);
    parts.end_component();
  }
}

}  // namespace

TriangleMesh generate_spheres_behind_wall(const SpheresBehindWallOptions& options) {
  PartGiver whole;
  append_spheres_behind_wall(options, whole);
  return std::move(whole.part);
}

void stream_spheres_behind_wall(const SpheresBehindWallOptions& options, const PartVisitor& visit) {
  PartGiver parts(visit);
  append_spheres_behind_wall(options, parts);
  parts.finish();
}

}  // namespace occlod
