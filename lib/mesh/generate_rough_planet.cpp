#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "base/option_checker.h"
#include "mesh/octahedron_lattice.h"
#include "base/portable_math.h"
#include "mesh/share_tasks.h"
#include "occlod/mesh/generate.h"

namespace occlod {
namespace {

double mix(double a, double b, double t) noexcept { return a + (b - a) * t; }

double smoothstep(double t) noexcept { return t * t * (3.0 - 2.0 * t); }

// Value noise in [-1, 1]: random numbers on the integer lattice, blended smoothly between. The numbers round the last
// point are kept: the next point is near it, and mostly in the same cell.
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
  glm::dvec3 below_{std::numeric_limits<double>::infinity()};  // the smallest corner of the cell; of none yet
  double corners_[2][2][2] = {};                               // along x, y, z
};

// Octaves with halving heights whose sum is 1: the result lies in [-1, 1].
class FractalNoise {
 public:
  explicit FractalNoise(const RoughPlanetOptions& options) : frequency_(options.frequency) {
    for (int octave = 0; octave < options.octaves; ++octave) {
      octaves_.emplace_back(scatter(options.seed + static_cast<std::uint64_t>(octave)));
    }
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

void check(const RoughPlanetOptions& options) {
  const OptionChecker check("rough planet");
  check.in_range("level", options.level, 0, 11);
  check.in_range("amplitude", options.amplitude, 0.0, 0.99);
  check.in_range("frequency", options.frequency, 0.0, 1e6);
  check.in_range("octaves", options.octaves, 0, 30);
}

// Between two rings, both with their vertices.
TriangleMesh bands(const OctahedronLattice& lattice, std::size_t first_ring, std::size_t last_ring,
                   const RoughPlanetOptions& options) {
  TriangleMesh mesh;
  const std::size_t first = lattice.ring_start(first_ring);
  const std::size_t end =
      last_ring + 1 < lattice.ring_count() ? lattice.ring_start(last_ring + 1) : lattice.vertex_count();
  mesh.positions.resize(end - first);
  share_tasks(last_ring + 1 - first_ring, [&](TaskQueue& rings) {
    FractalNoise noise(options);
    while (const auto task = rings.next()) {
      const std::size_t ring = first_ring + *task;
      auto position = mesh.positions.begin() + static_cast<std::ptrdiff_t>(lattice.ring_start(ring) - first);
      lattice.for_each_direction(ring, [&](const glm::dvec3& direction) {
        const double radius = 1.0 + options.amplitude * noise.at(direction);
        *position++ = direction * radius;
      });
    }
  });
  lattice.append_bands(first_ring, last_ring, 0, mesh.triangles);
  return mesh;
}

}  // namespace

TriangleMesh generate_rough_planet(const RoughPlanetOptions& options) {
  check(options);
  const OctahedronLattice lattice(options.level);
  return bands(lattice, 0, lattice.ring_count() - 1, options);
}

void stream_rough_planet(const RoughPlanetOptions& options, const PartVisitor& visit) {
  check(options);
  constexpr std::size_t most_vertices = std::size_t{1} << 18U;
  const OctahedronLattice lattice(options.level);
  const std::size_t last = lattice.ring_count() - 1;
  for (std::size_t first = 0; first < last;) {
    std::size_t end = first + 1;
    while (end < last && lattice.ring_start(end + 1) - lattice.ring_start(first) < most_vertices) ++end;
    // A ring of the part before begins each but the first.
    const std::size_t repeated = first == 0 ? 0 : lattice.ring_start(first + 1) - lattice.ring_start(first);
    visit(bands(lattice, first, end, options), repeated);
    first = end;
  }
}

}  // namespace occlod
