#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/arithmetic.h"
#include "base/option_checker.h"
#include "mesh/generators.h"
#include "occlod/mesh.h"

namespace occlod {
namespace {

constexpr int lattice_cells = 48;  // pipes run along the edges of a lattice in the unit cube
constexpr int shortest_piece = 2;  // in lattice edges; longer than a pipe's diameter, so that mitres do not cross
constexpr double thinnest = 0.003;
constexpr double thickest = 0.009;

struct Heading {
  int axis;
  int sign;
  [[nodiscard]] glm::dvec3 direction() const {
    glm::dvec3 d(0.0);
    d[axis] = sign;
    return d;
  }
};

struct Bundle {
  int pipes;
  int bends;  // straight pieces of each pipe
  int sides;  // corners of the cross-section
  std::uint64_t seed;
};

class PipeBuilder {
 public:
  PipeBuilder(const Bundle& bundle, RandomStream& random, TriangleMesh& mesh)
      : bundle_(bundle), random_(random), mesh_(mesh) {}

  void build() {
    start();
    append_cap_center();
    append_ring(heading_.direction());
    for (int piece = 0; piece < bundle_.bends; ++piece) {
      advance();
      const Heading next = turn();
      const bool last = piece + 1 == bundle_.bends;
      append_ring(last ? heading_.direction() : next.direction());
      if (!last) heading_ = next;
    }
    append_cap_center();
    append_triangles();
  }

 private:
  void start() {
    first_vertex_ = static_cast<VertexId>(mesh_.vertex_count());
    const double radius = random_.between(thinnest, thickest);
    for (int axis = 0; axis < 3; ++axis) place_[axis] = 1 + random_.below(lattice_cells - 1);
    heading_ = {random_.below(3), 1};
    choose_sign(heading_);
    const glm::dvec3 along = heading_.direction();
    glm::dvec3 u(0.0);
    u[(heading_.axis + 1) % 3] = 1.0;
    const glm::dvec3 v = glm::cross(along, u);
    offsets_.clear();
    for (int corner = 0; corner < bundle_.sides; ++corner) {
      const glm::dvec2 c = unit_circle_corner(corner, bundle_.sides);
      offsets_.push_back(radius * (c.x * u + c.y * v));
    }
  }

  [[nodiscard]] int room(const Heading& heading) const {
    return heading.sign > 0 ? lattice_cells - 1 - place_[heading.axis] : place_[heading.axis] - 1;
  }

  // Chooses the direction along the axis at random, unless there is too little room that way.
  void choose_sign(Heading& heading) {
    if (random_.below(2) == 0) heading.sign = -heading.sign;
    if (room(heading) < shortest_piece) heading.sign = -heading.sign;
  }

  void advance() {
    const int longest = std::min(room(heading_), lattice_cells / 3);
    place_[heading_.axis] += heading_.sign * (shortest_piece + random_.below(longest - shortest_piece + 1));
  }

  Heading turn() {
    Heading next{(heading_.axis + 1 + random_.below(2)) % 3, 1};
    choose_sign(next);
    return next;
  }

  // Appends the ring where the pipe turns from its heading into `next`: each line along its surface is extended to the
  // mitre plane, and the offsets turn with the pipe. With next = heading the cut is straight.
  void append_ring(const glm::dvec3& next) {
    const glm::dvec3 along = heading_.direction();
    for (glm::dvec3& offset : offsets_) {
      const double beyond = next == along ? 0.0 : -glm::dot(offset, next);
      const glm::dvec3 on_mitre = offset + beyond * along;
      mesh_.positions.emplace_back(center() + on_mitre);
      offset = on_mitre - glm::dot(on_mitre, next) * next;
    }
  }

  void append_cap_center() { mesh_.positions.emplace_back(center()); }

  [[nodiscard]] glm::dvec3 center() const { return glm::dvec3(place_) / static_cast<double>(lattice_cells); }

  // Appends triangles. The vertices are the first cap's centre, the rings and the last cap's centre. Rings run
  // counter-clockwise seen against the heading.
  void append_triangles() {
    const auto sides = static_cast<VertexId>(bundle_.sides);
    const auto rings = static_cast<VertexId>(bundle_.bends) + 1;
    const auto at = [&](VertexId ring, VertexId corner) { return first_vertex_ + 1 + ring * sides + corner % sides; };
    const VertexId last_center = at(rings, 0);
    for (VertexId corner = 0; corner < sides; ++corner) {
      mesh_.triangles.emplace_back(first_vertex_, at(0, corner + 1), at(0, corner));
      for (VertexId ring = 0; ring + 1 < rings; ++ring) {
        mesh_.triangles.emplace_back(at(ring, corner), at(ring, corner + 1), at(ring + 1, corner + 1));
        mesh_.triangles.emplace_back(at(ring, corner), at(ring + 1, corner + 1), at(ring + 1, corner));
      }
      mesh_.triangles.emplace_back(last_center, at(rings - 1, corner), at(rings - 1, corner + 1));
    }
  }

  const Bundle& bundle_;
  RandomStream& random_;
  TriangleMesh& mesh_;
  VertexId first_vertex_ = 0;
  glm::ivec3 place_{0};  // of the pipe's axis, in lattice edges
  Heading heading_{0, 1};
  std::vector<glm::dvec3> offsets_;  // from the axis to the lines along the pipe's surface
};

Bundle bundle_of(const GeneratorValues& values) {
  return {value_of(values, "pipes"), value_of(values, "bends"), value_of(values, "sides"),
          value_of<std::uint64_t>(values, "seed")};
}

// Returns about half the number of triangles.
double size_of(const Bundle& bundle) { return double{1.0} * bundle.pipes * (bundle.bends + 1) * bundle.sides; }

void append_bundle(const Bundle& bundle, PartGiver& parts) {
  RandomStream random(bundle.seed);
  PipeBuilder builder(bundle, random, parts.part);
  for (int pipe = 0; pipe < bundle.pipes; ++pipe) {
    builder.build();
    parts.end_component();
  }
}

}  // namespace

// Long thin closed components, as in plant models.
void append_pipes(const GeneratorValues& values, PartGiver& parts) {
  const Bundle bundle = bundle_of(values);
  OptionChecker("pipes").in_range("pipes * (bends + 1) * sides", size_of(bundle), 0.0, 1e9);
  append_bundle(bundle, parts);
}

namespace {

// Lengths are in metres.
constexpr double wall = 0.3;   // thickness of walls and floors
constexpr double room = 5.0;   // height of a storey, length of a bay, edge of a bundle of pipes
constexpr double aisle = 3.0;  // between the bundles on both sides of it
constexpr double door_width = 1.2;
constexpr double door_height = 2.2;
constexpr double inset = 0.05;  // of bundles from walls, floor and ceiling

// Floors and walls as one solid: some boxes of a grid with uneven steps. Doors, bays and the shaft are the boxes left
// out.
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

  // Returns the corner of a bay's bundle with the smallest coordinates, on one side of the aisle or the other.
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
    // The last of several bays has no floors in its aisle: a shaft goes through all storeys.
    if (p.z % 3 == 0) return bays_ == 1 || storeys_ == 1 || p.x != count(0) - 2 || p.y < 2 || p.y > 4;
    const bool is_door = p.y == 3 && p.z % 3 == 1;
    return p.x % 2 == 0 && !is_door;
  }

  // Appends the sides of a box towards boxes that are not solid, each as two triangles, counter-clockwise seen from
  // outside.
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
  std::vector<double> steps_[3];   // widths of the grid's steps, along each axis
  std::vector<double> places_[3];  // coordinates at which the steps begin and end
  std::unordered_map<int, VertexId> vertices_;
};

// Appends pipes in the cube of a room's side at `corner`, which has its smallest coordinates.
void append_bundle_at(const glm::dvec3& corner, const Bundle& bundle, PartGiver& parts) {
  const PartVisitor place = [&](const TriangleMesh& pipes, std::size_t) {
    TriangleMesh& mesh = parts.part;
    const auto first = static_cast<VertexId>(mesh.vertex_count());
    for (const glm::vec3& p : pipes.positions)
      mesh.positions.emplace_back(corner + (room - 2.0 * inset) * glm::dvec3(p));
    for (const Triangle& t : pipes.triangles) mesh.triangles.push_back(t + first);
    parts.end_component();
  };
  PartGiver in_unit_cube(place);
  append_bundle(bundle, in_unit_cube);
  in_unit_cube.give();
}

}  // namespace

// A plant of several storeys: floors and walls in one piece, doors along an aisle, a shaft at its end, and bundles of
// pipes on both sides of the aisle. It extends from the origin to (5.3 bays + 0.3, 13.6, 5.3 storeys + 0.3). The
// defaults make 12.8 million triangles.
void append_plant(const GeneratorValues& values, PartGiver& parts) {
  const int storeys = value_of(values, "storeys"), bays = value_of(values, "bays");
  Bundle bundle = bundle_of(values);
  OptionChecker("plant").in_range("2 * storeys * bays * pipes * (bends + 1) * sides",
                                  2.0 * storeys * bays * size_of(bundle), 0.0, 1e9);

  Structure structure(storeys, bays);
  structure.append_to(parts.part);
  bundle.seed = scatter(bundle.seed);
  for (int storey = 0; storey < storeys; ++storey)
    for (int bay = 0; bay < bays; ++bay)
      for (int side = 0; side < 2; ++side, bundle.seed += 0x9e3779b97f4a7c15ULL)
        append_bundle_at(structure.bundle_corner(storey, bay, side), bundle, parts);
}

}  // namespace occlod
