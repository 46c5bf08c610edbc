#include <utility>

#include "base/option_checker.h"
#include "mesh/box_lattice.h"
#include "mesh/part_giver.h"
#include "base/portable_math.h"
#include "occlod/mesh/generate.h"

namespace occlod {
namespace {

// Metres.
constexpr double block_pitch = 60.0;  // from block to block: the block itself and one street
constexpr double block_width = 46.0;
constexpr double alley = 4.0;         // between the buildings of one block
constexpr double ground_depth = 4.0;  // the ground is a slab whose top is z = 0; buildings stand one metre in it
constexpr double recess = 0.6;        // of windows

struct Building {
  glm::dvec2 low;   // corner on the ground
  glm::dvec2 size;  // of the ground plan
  double height;
};

// A lattice point strictly inside a wall is a window, set back, or flush with the wall.
glm::dvec3 facade_point(const Building& building, glm::ivec3 p, int cells, RandomStream& random) {
  const glm::dvec3 low(building.low, -1.0);
  const glm::dvec3 size(building.size, building.height + 1.0);
  glm::dvec3 point = low + size * glm::dvec3(p) / static_cast<double>(cells);
  const auto inside = [cells](int coordinate) { return coordinate > 0 && coordinate < cells; };
  if (!inside(p.z) || inside(p.x) == inside(p.y)) return point;
  const int across = inside(p.x) ? 1 : 0;
  if (random.below(2) == 0) point[across] += p[across] == 0 ? recess : -recess;
  return point;
}

void append_building(TriangleMesh& mesh, const Building& building, int cells, RandomStream& random) {
  const BoxLattice lattice(glm::ivec3{cells});
  const auto first = static_cast<VertexId>(mesh.vertex_count());
  lattice.for_each_point([&](glm::ivec3 p) { mesh.positions.emplace_back(facade_point(building, p, cells, random)); });
  lattice.append_triangles(first, mesh.triangles);
}

void append_ground(TriangleMesh& mesh, int blocks) {
  const int cells = 2 * blocks;
  const double width = blocks * block_pitch;
  const BoxLattice lattice({cells, cells, 1});
  lattice.for_each_point([&](glm::ivec3 p) {
    mesh.positions.emplace_back(width * p.x / cells, width * p.y / cells, ground_depth * (p.z - 1));
  });
  lattice.append_triangles(0, mesh.triangles);
}

// Heights grow towards the middle of the city.
Building plan_building(glm::ivec2 block, glm::ivec2 quarter, int blocks, RandomStream& random) {
  constexpr double plot = (block_width - alley) / 2.0;
  const glm::dvec2 street((block_pitch - block_width) / 2.0);
  const glm::dvec2 corner = block_pitch * glm::dvec2(block) + street + (plot + alley) * glm::dvec2(quarter);
  // One number after the other: the order of arguments and of sums is the compiler's.
  glm::dvec2 size;
  size.y = random.between(0.75, 1.0) * plot;
  size.x = random.between(0.75, 1.0) * plot;
  const glm::dvec2 from_middle = (glm::dvec2(block) + 0.5) * 2.0 / static_cast<double>(blocks) - 1.0;
  const double distance2 = (from_middle.x * from_middle.x + from_middle.y * from_middle.y) / 2.0;
  const double lowest = random.between(12.0, 30.0);
  const double more = random.between(0.0, 90.0) * (1.0 - distance2);
  return {corner + (plot - size) / 2.0, size, lowest + more};
}

void append_city(const CityOptions& options, PartGiver& parts) {
  const OptionChecker check("city");
  check.in_range("blocks", options.blocks, 1, 256);
  check.in_range("facade_cells", options.facade_cells, 1, 256);
  const double walls = 4.0 * options.blocks * options.blocks * 6.0 * options.facade_cells * options.facade_cells;
  check.in_range("blocks^2 * facade_cells^2 * 48", 2.0 * walls, 0.0, 1e9);

  RandomStream random(options.seed);
  append_ground(parts.part, options.blocks);
  for (int y = 0; y < options.blocks; ++y) {
    for (int x = 0; x < options.blocks; ++x) {
      for (int quarter = 0; quarter < 4; ++quarter) {
        const Building building = plan_building({x, y}, {quarter % 2, quarter / 2}, options.blocks, random);
        append_building(parts.part, building, options.facade_cells, random);
        parts.end_component();
      }
    }
  }
}

}  // namespace

TriangleMesh generate_city(const CityOptions& options) {
  PartGiver whole;
  append_city(options, whole);
  return std::move(whole.part);
}

void stream_city(const CityOptions& options, const PartVisitor& visit) {
  PartGiver parts(visit);
  append_city(options, parts);
  parts.finish();
}

}  // namespace occlod
