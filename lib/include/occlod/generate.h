// Generates closed test meshes from a few numbers. Deterministic: the same options give the same bytes on every machine
// with IEEE arithmetic. All functions throw Error that names an option out of its range or a mesh that would be too
// large. O(size of the mesh).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "occlod/mesh.h"

namespace occlod {

// Takes the next part of a mesh that is larger than memory: some 500,000 triangles with ids into the part's own
// vertices. The first `repeated` vertices are the last ones of the previous part; without them, the vertices and
// triangles of all parts are those of the whole mesh, in the same order. Connected components are not cut, except the
// rough planet.
using PartVisitor = std::function<void(const TriangleMesh& part, std::size_t repeated)>;

// Options of the rough planet of Birkholz & Rahn: an octahedron lattice, subdivided `level` times, pushed onto the unit
// sphere and displaced along the radius by seeded value noise, so that normal cones are wide. It has 4^(level+1)+2
// vertices and 8*4^level triangles.
struct RoughPlanetOptions {
  int level = 8;            // subdivisions, 0 to 11
  std::uint64_t seed = 1;   // of the noise
  double amplitude = 0.08;  // largest displacement relative to the radius, 0 to 0.99
  double frequency = 4.0;   // noise cells per radius in the first octave, 0 to 1e6
  int octaves = 6;          // 0 to 30, each with twice the frequency and half the height of the one before
};
// Returns the planet around the origin, with radius 1 before displacement.
[[nodiscard]] TriangleMesh generate_rough_planet(const RoughPlanetOptions& options);
// Gives the planet in parts, from pole to pole.
void stream_rough_planet(const RoughPlanetOptions& options, const PartVisitor& visit);

// Options of a city: blocks of box-shaped buildings on a ground plane, z up. Many closed components hide each other at
// street level.
struct CityOptions {
  int blocks = 16;         // blocks along each side, 1 to 256; 4 buildings a block
  int facade_cells = 8;    // grid cells along each edge of a wall, 1 to 256: 2 * cells^2 triangles a wall
  std::uint64_t seed = 1;  // of heights and footprints
};
// Returns the city, of at most 1e9 triangles.
[[nodiscard]] TriangleMesh generate_city(const CityOptions& options);
// Gives the city in parts.
void stream_city(const CityOptions& options, const PartVisitor& visit);

// Options of a bundle of bent pipes in a unit cube: long thin closed components, as in plant models.
struct PipesOptions {
  int pipes = 64;          // 1 to 1,000,000
  int bends = 12;          // straight pieces of each pipe, 1 to 100,000
  int sides = 16;          // corners of the cross-section, 3 to 4,096
  std::uint64_t seed = 1;  // of the routes
};
// Returns the pipes. pipes * (bends + 1) * sides is at most 1e9.
[[nodiscard]] TriangleMesh generate_pipes(const PipesOptions& options);
// Gives the pipes in parts.
void stream_pipes(const PipesOptions& options, const PartVisitor& visit);

// Options of a plant of several storeys: floors and walls in one piece, doors along an aisle, a shaft at its end, and
// bundles of pipes on both sides of the aisle. z is up; it extends, in metres, from the origin to (5.3 bays + 0.3,
// 13.6, 5.3 storeys + 0.3).
struct PlantOptions {
  int storeys = 4;         // 1 to 64
  int bays = 8;            // rooms along the aisle of each storey, 1 to 256
  int pipes = 64;          // of each bundle, 1 to 10,000; there are two bundles a bay
  int bends = 48;          // straight pieces of each pipe, 1 to 100,000
  int sides = 32;          // corners of the cross-section, 3 to 4,096
  std::uint64_t seed = 1;  // of the routes
};
// Returns the plant. 2 * storeys * bays * pipes * (bends + 1) * sides is at most 1e9. The defaults make 12.8 million
// triangles.
[[nodiscard]] TriangleMesh generate_plant(const PlantOptions& options);
// Gives the plant in parts.
void stream_plant(const PlantOptions& options, const PartVisitor& visit);

// Options of a wall in the plane x = 0 with a cloud of spheres at x < 0: from +x everything but the wall is hidden.
struct SpheresBehindWallOptions {
  int spheres = 64;        // 1 to 1,000,000
  int level = 4;           // subdivisions of each sphere's octahedron, 0 to 8
  int wall_cells = 32;     // grid cells along each edge of the wall, 1 to 4,096
  std::uint64_t seed = 1;  // of positions and radii
};
// Returns the wall and the spheres. spheres * 4^level is at most 1e8.
[[nodiscard]] TriangleMesh generate_spheres_behind_wall(const SpheresBehindWallOptions& options);
// Gives the wall and the spheres in parts.
void stream_spheres_behind_wall(const SpheresBehindWallOptions& options, const PartVisitor& visit);

}  // namespace occlod
