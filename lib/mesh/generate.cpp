#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "base/arithmetic.h"
#include "base/option_checker.h"
#include "base/threads.h"
#include "mesh/generators.h"
#include "occlod/mesh.h"

namespace occlod {
namespace {

// The surface lattice of a box: cells.x by cells.y by cells.z, welded along its edges, triangles counter-clockwise seen
// from outside.
class BoxLattice {
 public:
  explicit BoxLattice(glm::ivec3 cells) : cells_(cells) {}  // each >= 1

  // Calls place(glm::ivec3 lattice point) once per vertex, in the order of their indices: layer by layer upwards.
  template <class Place>
  void for_each_point(Place place) const;

  // Appends 4 (xy + yz + zx) triangles with `first_vertex` added to every index.
  void append_triangles(VertexId first_vertex, std::vector<Triangle>& triangles) const;

 private:
  [[nodiscard]] VertexId index(glm::ivec3 p) const;
  [[nodiscard]] int ring_place(glm::ivec3 p) const;
  void append_side(int axis, bool far, VertexId first_vertex, std::vector<Triangle>& triangles) const;

  glm::ivec3 cells_;
};

template <class Place>
void BoxLattice::for_each_point(Place place) const {
  const int nx = cells_.x;
  const int ny = cells_.y;
  for (int z = 0; z <= cells_.z; ++z) {
    if (z == 0 || z == cells_.z) {
      for (int y = 0; y <= ny; ++y) {
        for (int x = 0; x <= nx; ++x) place(glm::ivec3(x, y, z));
      }
      continue;
    }
    for (int x = 0; x < nx; ++x) place(glm::ivec3(x, 0, z));
    for (int y = 0; y < ny; ++y) place(glm::ivec3(nx, y, z));
    for (int x = nx; x > 0; --x) place(glm::ivec3(x, ny, z));
    for (int y = ny; y > 0; --y) place(glm::ivec3(0, y, z));
  }
}

VertexId BoxLattice::index(glm::ivec3 p) const {
  const int layer = (cells_.x + 1) * (cells_.y + 1);
  const int ring = 2 * (cells_.x + cells_.y);
  if (p.z == 0) return static_cast<VertexId>(p.y * (cells_.x + 1) + p.x);
  if (p.z == cells_.z) return static_cast<VertexId>(layer + (p.z - 1) * ring + p.y * (cells_.x + 1) + p.x);
  return static_cast<VertexId>(layer + (p.z - 1) * ring + ring_place(p));
}

int BoxLattice::ring_place(glm::ivec3 p) const {
  if (p.y == 0) return p.x;
  if (p.x == cells_.x) return cells_.x + p.y;
  if (p.y == cells_.y) return cells_.x + cells_.y + (cells_.x - p.x);
  return 2 * cells_.x + cells_.y + (cells_.y - p.y);
}

void BoxLattice::append_triangles(VertexId first_vertex, std::vector<Triangle>& triangles) const {
  for (int axis = 0; axis < 3; ++axis) {
    append_side(axis, false, first_vertex, triangles);
    append_side(axis, true, first_vertex, triangles);
  }
}

// Appends the side that is normal to `axis` and contains the origin, or the opposite side when `far`.
void BoxLattice::append_side(int axis, bool far, VertexId first_vertex, std::vector<Triangle>& triangles) const {
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  for (int j = 0; j < cells_[v]; ++j) {
    for (int i = 0; i < cells_[u]; ++i) {
      const auto at = [&](int du, int dv) {
        glm::ivec3 p(0);
        p[axis] = far ? cells_[axis] : 0;
        p[u] = i + du;
        p[v] = j + dv;
        return first_vertex + index(p);
      };
      const VertexId b = far ? at(1, 0) : at(0, 1);
      const VertexId d = far ? at(0, 1) : at(1, 0);
      triangles.emplace_back(at(0, 0), b, at(1, 1));
      triangles.emplace_back(at(0, 0), at(1, 1), d);
    }
  }
}

// The lattice |x| + |y| + |z| = n on an octahedron, in rings of equal z from the north pole (0, 0, n) down. Ring m has
// 4 m points (each pole one), so indices follow from (ring, place in the ring) without a map of edges.
class OctahedronLattice {
 public:
  explicit OctahedronLattice(int subdivisions);

  [[nodiscard]] std::size_t vertex_count() const noexcept { return 4 * size_t_n() * size_t_n() + 2; }
  [[nodiscard]] std::size_t triangle_count() const noexcept { return 8 * size_t_n() * size_t_n(); }

  // Number of rings of equal z; ring 0 is the north pole.
  [[nodiscard]] std::size_t ring_count() const noexcept { return 2 * size_t_n() + 1; }
  // Returns the index of the first vertex of a ring.
  [[nodiscard]] std::size_t ring_start(std::size_t ring) const noexcept;

  // Calls visit(direction) once per vertex of a ring in the order of their indices. Directions have unit length (to a
  // few ulp).
  template <class Visit>
  void for_each_direction(std::size_t ring, Visit visit) const;

  // Appends the triangles, counter-clockwise seen from outside, with `first_vertex` added to every index.
  void append_triangles(VertexId first_vertex, std::vector<Triangle>& triangles) const {
    append_bands(0, ring_count() - 1, first_vertex, triangles);
  }
  // Appends the triangles between the rings first_ring and last_ring; the first vertex of first_ring gets the index
  // first_vertex.
  void append_bands(std::size_t first_ring, std::size_t last_ring, VertexId first_vertex,
                    std::vector<Triangle>& triangles) const;

 private:
  [[nodiscard]] std::size_t size_t_n() const noexcept { return static_cast<std::size_t>(n_); }
  [[nodiscard]] double warped(int coordinate) const noexcept {
    return coordinate < 0 ? -warp_[static_cast<std::size_t>(-coordinate)] : warp_[static_cast<std::size_t>(coordinate)];
  }
  [[nodiscard]] glm::dvec3 direction(int x, int y, int z) const noexcept;
  void append_band(VertexId narrow, VertexId wide, int m, bool north, std::vector<Triangle>& triangles) const;

  int n_;                     // edges along each edge of the octahedron
  std::vector<double> warp_;  // sin(pi/2 * i/n): with this warp, areas on the sphere differ by a factor of 1.7 instead
                              // of 5.2
};

template <class Visit>
void OctahedronLattice::for_each_direction(std::size_t ring, Visit visit) const {
  const int z = n_ - static_cast<int>(ring);
  const int m = n_ - std::abs(z);
  if (m == 0) visit(direction(0, 0, z));
  for (int i = 0; i < m; ++i) visit(direction(m - i, i, z));
  for (int i = 0; i < m; ++i) visit(direction(-i, m - i, z));
  for (int i = 0; i < m; ++i) visit(direction(i - m, -i, z));
  for (int i = 0; i < m; ++i) visit(direction(i, i - m, z));
}

inline glm::dvec3 OctahedronLattice::direction(int x, int y, int z) const noexcept {
  const glm::dvec3 p(warped(x), warped(y), warped(z));
  return p / std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
}

OctahedronLattice::OctahedronLattice(int subdivisions) : n_(1 << subdivisions) {
  warp_.reserve(size_t_n() + 1);
  for (int i = 0; i <= n_; ++i) warp_.push_back(sine_of_quarter_turns(static_cast<double>(i) / n_));
}

void OctahedronLattice::append_bands(std::size_t first_ring, std::size_t last_ring, VertexId first_vertex,
                                     std::vector<Triangle>& triangles) const {
  const auto vertex_of = [&](std::size_t ring) {
    return first_vertex + static_cast<VertexId>(ring_start(ring) - ring_start(first_ring));
  };
  for (std::size_t ring = first_ring; ring < last_ring; ++ring) {
    const VertexId above = vertex_of(ring), below = vertex_of(ring + 1);
    const auto m = static_cast<int>(ring);
    if (m < n_)
      append_band(above, below, m, true, triangles);
    else
      append_band(below, above, 2 * n_ - 1 - m, false, triangles);
  }
}

std::size_t OctahedronLattice::ring_start(std::size_t ring) const noexcept {
  if (ring == 0) return 0;
  if (ring <= size_t_n()) return 1 + 2 * ring * (ring - 1);
  const std::size_t m = 2 * size_t_n() - ring;
  return vertex_count() - 1 - 2 * m * (m + 1);
}

// Appends the band between the ring of 4 m points that starts at `narrow` and the ring of 4 (m + 1) points that starts
// at `wide`.
void OctahedronLattice::append_band(VertexId narrow, VertexId wide, int m, bool north,
                                    std::vector<Triangle>& triangles) const {
  const auto inner = static_cast<VertexId>(m);
  const VertexId outer = inner + 1;
  const auto push = [&](VertexId a, VertexId b, VertexId c) {
    triangles.push_back(north ? Triangle(a, b, c) : Triangle(a, c, b));
  };
  for (VertexId quadrant = 0; quadrant < 4; ++quadrant) {
    const auto near_pole = [&](VertexId i) { return m == 0 ? narrow : narrow + (quadrant * inner + i) % (4 * inner); };
    const auto far_from_pole = [&](VertexId i) { return wide + (quadrant * outer + i) % (4 * outer); };
    for (VertexId i = 0; i < outer; ++i) {
      push(near_pole(i), far_from_pole(i), far_from_pole(i + 1));
      if (i < inner) push(near_pole(i), far_from_pole(i + 1), near_pole(i + 1));
    }
  }
}

double mix(double a, double b, double t) noexcept { return a + (b - a) * t; }

double smoothstep(double t) noexcept { return t * t * (3.0 - 2.0 * t); }

// Value noise in [-1, 1]: random numbers on the integer lattice, blended smoothly between lattice points. Keeps the
// numbers around the last point, because the next point is usually in the same cell.
class ValueNoise {
 public:
  explicit ValueNoise(std::uint64_t seed) noexcept : seed_(seed) {}

  double at(const glm::dvec3& p) noexcept {
    const glm::dvec3 below(std::floor(p.x), std::floor(p.y), std::floor(p.z));
    if (below != below_) enter_cell(below);
    const double x = smoothstep(p.x - below.x);
    const double y = smoothstep(p.y - below.y);
    const double z = smoothstep(p.z - below.z);
    double along_x[2];
    for (int i = 0; i < 2; ++i) {
      along_x[i] = mix(mix(corners_[i][0][0], corners_[i][0][1], z), mix(corners_[i][1][0], corners_[i][1][1], z), y);
    }
    return mix(along_x[0], along_x[1], x);
  }

 private:
  void enter_cell(const glm::dvec3& below) noexcept {
    below_ = below;
    const glm::i64vec3 cell(below);
    for (int i = 0; i < 2; ++i) {
      const std::uint64_t hash_x = scatter(seed_ + static_cast<std::uint64_t>(cell.x + i));
      for (int j = 0; j < 2; ++j) {
        const std::uint64_t hash_y = scatter(hash_x + static_cast<std::uint64_t>(cell.y + j));
        for (int k = 0; k < 2; ++k) {
          const std::uint64_t hash = scatter(hash_y + static_cast<std::uint64_t>(cell.z + k));
          corners_[i][j][k] = static_cast<double>(static_cast<std::int64_t>(hash)) * 0x1p-63;
        }
      }
    }
  }

  std::uint64_t seed_;
  glm::dvec3 below_{std::numeric_limits<double>::infinity()};  // smallest corner of the current cell; infinite when
                                                               // there is none yet
  double corners_[2][2][2] = {};                               // values at the cell's corners, by x, y, z
};

// Sums octaves of noise with halving heights that add up to 1, so the result is in [-1, 1].
class FractalNoise {
 public:
  FractalNoise(std::uint64_t seed, double frequency, int octaves) : frequency_(frequency) {
    for (int octave = 0; octave < octaves; ++octave)
      octaves_.emplace_back(scatter(seed + static_cast<std::uint64_t>(octave)));
  }

  double at(const glm::dvec3& direction) noexcept {
    double sum = 0.0;
    double heights = 0.0;
    double height = 1.0;
    double frequency = frequency_;
    for (ValueNoise& octave : octaves_) {
      sum += height * octave.at(direction * frequency);
      heights += height;
      height *= 0.5;
      frequency *= 2.0;
    }
    return heights > 0.0 ? sum / heights : 0.0;
  }

 private:
  double frequency_;
  std::vector<ValueNoise> octaves_;
};

// Returns the bands between two rings, including the vertices of both.
TriangleMesh bands(const OctahedronLattice& lattice, std::size_t first_ring, std::size_t last_ring, double amplitude,
                   const FractalNoise& noise) {
  TriangleMesh mesh;
  const std::size_t first = lattice.ring_start(first_ring);
  const std::size_t end =
      last_ring + 1 < lattice.ring_count() ? lattice.ring_start(last_ring + 1) : lattice.vertex_count();
  mesh.positions.resize(end - first);
  const auto displace = [&](FractalNoise& own_noise, std::size_t task) {
    const std::size_t ring = first_ring + task;
    auto position = mesh.positions.begin() + static_cast<std::ptrdiff_t>(lattice.ring_start(ring) - first);
    lattice.for_each_direction(ring, [&](const glm::dvec3& direction) {
      const double radius = 1.0 + amplitude * own_noise.at(direction);
      *position++ = direction * radius;
    });
  };
  for_each_task(
      last_ring + 1 - first_ring, thread_count(0), [&] { return noise; }, displace, [] {});
  lattice.append_bands(first_ring, last_ring, 0, mesh.triangles);
  return mesh;
}

}  // namespace

// The rough planet of Birkholz & Rahn: an octahedron lattice, subdivided `level` times, pushed onto the unit sphere and
// displaced along the radius by seeded value noise, so that normal cones are wide. It has 4^(level + 1) + 2 vertices.
// Parts go from pole to pole.
void append_rough_planet(const GeneratorValues& values, PartGiver& parts) {
  const OctahedronLattice lattice(value_of(values, "level"));
  const FractalNoise noise(value_of<std::uint64_t>(values, "seed"), value_of<double>(values, "frequency"),
                           value_of(values, "octaves"));
  const std::size_t max_vertices = parts.gives_parts() ? std::size_t{1} << 18U : lattice.vertex_count();
  const std::size_t last = lattice.ring_count() - 1;
  for (std::size_t first = 0; first < last;) {
    std::size_t end = first + 1;
    while (end < last && lattice.ring_start(end + 1) - lattice.ring_start(first) < max_vertices) ++end;
    // Every part but the first begins with the last ring of the part before.
    const std::size_t repeated = first == 0 ? 0 : lattice.ring_start(first + 1) - lattice.ring_start(first);
    parts.part = bands(lattice, first, end, value_of<double>(values, "amplitude"), noise);
    parts.give(repeated);
    first = end;
  }
}

namespace {

// Lengths are in metres.
constexpr double block_pitch = 60.0;  // from block to block: the block itself and one street
constexpr double block_width = 46.0;
constexpr double alley = 4.0;         // between the buildings of one block
constexpr double ground_depth = 4.0;  // the ground is a slab whose top is z = 0; buildings reach one metre into it
constexpr double recess = 0.6;        // depth of windows

struct Building {
  glm::dvec2 low;   // corner on the ground
  glm::dvec2 size;  // of the ground plan
  double height;
};

// Places a lattice point of a facade: points strictly inside a wall are windows, set back or flush with the wall at
// random.
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

// Plans a building; heights grow towards the middle of the city.
Building plan_building(glm::ivec2 block, glm::ivec2 quarter, int blocks, RandomStream& random) {
  constexpr double plot = (block_width - alley) / 2.0;
  const glm::dvec2 street((block_pitch - block_width) / 2.0);
  const glm::dvec2 corner = block_pitch * glm::dvec2(block) + street + (plot + alley) * glm::dvec2(quarter);
  // One random number per statement: C++ does not fix the evaluation order of arguments and operands.
  glm::dvec2 size;
  size.y = random.between(0.75, 1.0) * plot;
  size.x = random.between(0.75, 1.0) * plot;
  const glm::dvec2 from_middle = (glm::dvec2(block) + 0.5) * 2.0 / static_cast<double>(blocks) - 1.0;
  const double distance2 = (from_middle.x * from_middle.x + from_middle.y * from_middle.y) / 2.0;
  const double lowest = random.between(12.0, 30.0);
  const double more = random.between(0.0, 90.0) * (1.0 - distance2);
  return {corner + (plot - size) / 2.0, size, lowest + more};
}

}  // namespace

// A city of closed components that hide each other at street level.
void append_city(const GeneratorValues& values, PartGiver& parts) {
  const int blocks = value_of(values, "blocks"), cells = value_of(values, "facade_cells");
  const double walls = 4.0 * blocks * blocks * 6.0 * cells * cells;
  OptionChecker("city").in_range("blocks^2 * facade_cells^2 * 48", 2.0 * walls, 0.0, 1e9);

  RandomStream random(value_of<std::uint64_t>(values, "seed"));
  append_ground(parts.part, blocks);
  for (int y = 0; y < blocks; ++y) {
    for (int x = 0; x < blocks; ++x) {
      for (int quarter = 0; quarter < 4; ++quarter) {
        const Building building = plan_building({x, y}, {quarter % 2, quarter / 2}, blocks, random);
        append_building(parts.part, building, cells, random);
        parts.end_component();
      }
    }
  }
}

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

}  // namespace

// A wall in the plane x = 0 with a cloud of spheres at x < 0: from +x everything but the wall is hidden.
void append_spheres_behind_wall(const GeneratorValues& values, PartGiver& parts) {
  const int spheres = value_of(values, "spheres"), level = value_of(values, "level");
  OptionChecker("spheres-behind-wall")
      .in_range("spheres * 4^level", double{1.0} * spheres * (1 << (2 * level)), 0.0, 1e8);

  RandomStream random(value_of<std::uint64_t>(values, "seed"));
  append_wall(parts.part, value_of(values, "wall_cells"));
  const OctahedronLattice lattice(level);
  for (int sphere = 0; sphere < spheres; ++sphere) {
    append_sphere(parts.part, lattice, random);
    parts.end_component();
  }
}

}  // namespace occlod
