#include <cmath>

#include "mesh/generator_options.h"
#include "mesh/octahedron_lattice.h"
#include "mesh/portable_math.h"
#include "occlod/mesh/generate.h"

namespace occlod {
namespace {

struct NoiseCell {
  std::int64_t corner;  // the lattice coordinate below
  double blend;         // smoothstep of the place between it and the next
};

NoiseCell noise_cell(double coordinate) noexcept {
  const double below = std::floor(coordinate);
  const double t = coordinate - below;
  return {static_cast<std::int64_t>(below), t * t * (3.0 - 2.0 * t)};
}

double mix(double a, double b, double t) noexcept { return a + (b - a) * t; }

// Value noise in [-1, 1]: random numbers on the integer lattice, blended smoothly between.
double value_noise(const glm::dvec3& p, std::uint64_t seed) noexcept {
  const NoiseCell x = noise_cell(p.x);
  const NoiseCell y = noise_cell(p.y);
  const NoiseCell z = noise_cell(p.z);
  double along_x[2];
  for (int i = 0; i < 2; ++i) {
    const std::uint64_t hash_x = scatter(seed + static_cast<std::uint64_t>(x.corner + i));
    double along_y[2];
    for (int j = 0; j < 2; ++j) {
      const std::uint64_t hash_y = scatter(hash_x + static_cast<std::uint64_t>(y.corner + j));
      const auto at = [&](std::int64_t corner) {
        const std::uint64_t hash = scatter(hash_y + static_cast<std::uint64_t>(corner));
        return static_cast<double>(static_cast<std::int64_t>(hash)) * 0x1p-63;
      };
      along_y[j] = mix(at(z.corner), at(z.corner + 1), z.blend);
    }
    along_x[i] = mix(along_y[0], along_y[1], y.blend);
  }
  return mix(along_x[0], along_x[1], x.blend);
}

// Octaves with halving heights whose sum is 1: the result lies in [-1, 1].
double fractal_noise(const glm::dvec3& direction, const RoughPlanetOptions& options) noexcept {
  double sum = 0.0;
  double heights = 0.0;
  double height = 1.0;
  double frequency = options.frequency;
  for (int octave = 0; octave < options.octaves; ++octave) {
    sum += height * value_noise(direction * frequency, scatter(options.seed + static_cast<std::uint64_t>(octave)));
    heights += height;
    height *= 0.5;
    frequency *= 2.0;
  }
  return heights > 0.0 ? sum / heights : 0.0;
}

}  // namespace

TriangleMesh generate_rough_planet(const RoughPlanetOptions& options) {
  const OptionChecker check("rough planet");
  check.in_range("level", options.level, 0, 11);
  check.in_range("amplitude", options.amplitude, 0.0, 0.99);
  check.in_range("frequency", options.frequency, 0.0, 1e6);
  check.in_range("octaves", options.octaves, 0, 30);

  const OctahedronLattice lattice(options.level);
  TriangleMesh mesh;
  mesh.positions.reserve(lattice.vertex_count());
  lattice.for_each_direction([&](const glm::dvec3& direction) {
    const double radius = 1.0 + options.amplitude * fractal_noise(direction, options);
    mesh.positions.emplace_back(direction * radius);
  });
  lattice.append_triangles(0, mesh.triangles);
  return mesh;
}

}  // namespace occlod
