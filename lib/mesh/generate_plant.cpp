#include <glm/vec3.hpp>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/option_checker.h"
#include "mesh/part_giver.h"
#include "base/portable_math.h"
#include "occlod/mesh/generate.h"

namespace occlod {
namespace {

// Metres.
constexpr double wall = 0.3;   // thickness of walls and floors
constexpr double room = 5.0;   // height of a storey, length of a bay, edge of a bundle of pipes
constexpr double aisle = 3.0;  // between the bundles on both sides of it
constexpr double door_width = 1.2;
constexpr double door_height = 2.2;
constexpr double inset = 0.05;  // of bundles from walls, floor and ceiling

// Floors and walls as one solid: some boxes of a grid with uneven steps. Doors, bays and the shaft are those left out.
class Structure {
 public:
  Structure(int storeys, int bays) : storeys_(storeys), bays_(bays) {
    steps_[0] = {wall};
    for (int bay = 0; bay < bays; ++bay) steps_[0].insert(steps_[0].end(), {room, wall});
    constexpr double beside_door = (aisle - door_width) / 2.0;
    steps_[1] = {wall, room, beside_door, door_width, beside_door, room, wall};
    for (int storey = 0; storey < storeys; ++storey)
      steps_[2].insert(steps_[2].end(), {wall, door_height, room - door_height});
    steps_[2].push_back(wall);
    for (int axis = 0; axis < 3; ++axis) {
      places_[axis] = {0.0};
      for (const double step : steps_[axis]) places_[axis].push_back(places_[axis].back() + step);
    }
  }

  void append_to(TriangleMesh& mesh) {
    glm::ivec3 p;
    for (p.z = 0; p.z < count(2); ++p.z)
      for (p.y = 0; p.y < count(1); ++p.y)
        for (p.x = 0; p.x < count(0); ++p.x)
          if (is_solid(p)) append_box(mesh, p);
  }

  // Where the bundle of a bay begins, on one side of the aisle or the other.
  [[nodiscard]] glm::dvec3 bundle_corner(int storey, int bay, int side) const {
    return glm::dvec3(places_[0][static_cast<std::size_t>(2 * bay + 1)], places_[1][side == 0 ? 1 : 5],
                      places_[2][static_cast<std::size_t>(3 * storey + 1)]) +
           inset;
  }

 private:
  [[nodiscard]] int count(int axis) const { return static_cast<int>(steps_[axis].size()); }

  [[nodiscard]] bool is_solid(const glm::ivec3& p) const {
    if (p.x < 0 || p.y < 0 || p.z < 0 || p.x >= count(0) || p.y >= count(1) || p.z >= count(2)) return false;
    const bool outside = p.y == 0 || p.y == count(1) - 1 || p.x == 0 || p.x == count(0) - 1;
    if (outside || p.z == 0 || p.z == count(2) - 1) return true;
    // The last bay of several has no floors in its aisle: a shaft through all storeys.
    if (p.z % 3 == 0) return bays_ == 1 || storeys_ == 1 || p.x != count(0) - 2 || p.y < 2 || p.y > 4;
    const bool is_door = p.y == 3 && p.z % 3 == 1;
    return p.x % 2 == 0 && !is_door;
  }

  // Its sides towards boxes that are not solid, each as two triangles, counter-clockwise from outside.
  void append_box(TriangleMesh& mesh, const glm::ivec3& p) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side) {
        glm::ivec3 beside = p;
        beside[axis] += side == 0 ? -1 : 1;
        if (is_solid(beside)) continue;
        glm::ivec3 u(0), v(0), corner = p;
        u[(axis + 1) % 3] = v[(axis + 2) % 3] = 1;
        corner[axis] += side;
        if (side == 0) std::swap(u, v);
        const VertexId a = vertex(mesh, corner), b = vertex(mesh, corner + u), c = vertex(mesh, corner + u + v),
                       d = vertex(mesh, corner + v);
        mesh.triangles.emplace_back(a, b, c);
        mesh.triangles.emplace_back(a, c, d);
      }
    }
  }

  VertexId vertex(TriangleMesh& mesh, const glm::ivec3& p) {
    const int key = (p.z * (count(1) + 1) + p.y) * (count(0) + 1) + p.x;
    const auto [at, is_new] = vertices_.try_emplace(key, static_cast<VertexId>(mesh.vertex_count()));
    if (is_new) {
      const auto place = [&](int axis) { return places_[axis][static_cast<std::size_t>(p[axis])]; };
      mesh.positions.emplace_back(place(0), place(1), place(2));
    }
    return at->second;
  }

  int storeys_, bays_;
  std::vector<double> steps_[3];   // of the grid, along each axis
  std::vector<double> places_[3];  // where they begin and end
  std::unordered_map<int, VertexId> vertices_;
};

void append_bundle(PartGiver& parts, const PipesOptions& options, const glm::dvec3& corner) {
  stream_pipes(options, [&](const TriangleMesh& pipes, std::size_t) {
    TriangleMesh& mesh = parts.part;
    const auto first = static_cast<VertexId>(mesh.vertex_count());
    for (const glm::vec3& p : pipes.positions)
      mesh.positions.emplace_back(corner + (room - 2.0 * inset) * glm::dvec3(p));
    for (const Triangle& t : pipes.triangles) mesh.triangles.push_back(t + first);
    parts.end_component();
  });
}

void append_plant(const PlantOptions& options, PartGiver& parts) {
  const OptionChecker check("plant");
  check.in_range("storeys", options.storeys, 1, 64);
  check.in_range("bays", options.bays, 1, 256);
  check.in_range("pipes", options.pipes, 1, 10'000);
  check.in_range("bends", options.bends, 1, 100'000);
  check.in_range("sides", options.sides, 3, 4096);
  const double bundles = 2.0 * options.storeys * options.bays;
  check.in_range("2 * storeys * bays * pipes * (bends + 1) * sides",
                 bundles * options.pipes * (options.bends + 1) * options.sides, 0.0, 1e9);

  Structure structure(options.storeys, options.bays);
  structure.append_to(parts.part);
  std::uint64_t bundle = 0;
  for (int storey = 0; storey < options.storeys; ++storey)
    for (int bay = 0; bay < options.bays; ++bay)
      for (int side = 0; side < 2; ++side, ++bundle)
        append_bundle(
            parts,
            {options.pipes, options.bends, options.sides, scatter(options.seed) + bundle * 0x9e3779b97f4a7c15ULL},
            structure.bundle_corner(storey, bay, side));
}

}  // namespace

TriangleMesh generate_plant(const PlantOptions& options) {
  PartGiver whole;
  append_plant(options, whole);
  return std::move(whole.part);
}

void stream_plant(const PlantOptions& options, const PartVisitor& visit) {
  PartGiver parts(visit);
  append_plant(options, parts);
  parts.finish();
}

}  // namespace occlod
