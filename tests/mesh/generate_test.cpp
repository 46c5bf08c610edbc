#include "occlod/generate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "occlod/mesh.h"

namespace occlod {
namespace {

double signed_volume(const TriangleMesh& mesh) {
  double volume = 0.0;
  for (const Triangle& t : mesh.triangles) {
    volume += glm::dot(glm::dvec3(mesh.positions[t.x]),
                       glm::cross(glm::dvec3(mesh.positions[t.y]), glm::dvec3(mesh.positions[t.z]))) /
              6.0;
  }
  return volume;
}

// Closed, oriented, manifold, welded, without degenerate triangles: what every generator promises.
void expect_closed(const TriangleMesh& mesh, std::uint64_t components) {
  const CleanMesh result = clean(mesh, {}, "generated");
  EXPECT_EQ(result.mesh.positions, mesh.positions);  // nothing to weld or drop
  EXPECT_EQ(result.mesh.triangles, mesh.triangles);
  const MeshReport& r = result.report;
  EXPECT_EQ(r.boundary_edges, 0u);
  EXPECT_EQ(r.nonmanifold_edges, 0u);
  EXPECT_EQ(r.nonmanifold_vertices, 0u);
  EXPECT_EQ(r.inconsistent_edges, 0u);
  EXPECT_EQ(r.zero_area_triangles, 0u);
  EXPECT_EQ(r.repeated_triangles, 0u);
  EXPECT_EQ(r.components, components);
}

// The components of a mesh whose vertices come component by component, as generators make them.
std::vector<TriangleMesh> split(const TriangleMesh& mesh) {
  std::vector<TriangleMesh> parts;
  VertexId begin = 0;
  VertexId end = 0;
  for (const Triangle& t : mesh.triangles) {
    if (std::min({t.x, t.y, t.z}) >= end && !parts.empty()) begin = end;
    if (parts.empty() || std::min({t.x, t.y, t.z}) >= end) parts.emplace_back();
    end = std::max({end, t.x + 1, t.y + 1, t.z + 1});
    parts.back().triangles.push_back(t - Triangle(begin));
    parts.back().positions.assign(mesh.positions.begin() + begin, mesh.positions.begin() + end);
  }
  return parts;
}

TEST(RoughPlanet, HasTheCountsOfASubdividedOctahedron) {
  std::size_t quarter = 1;
  for (int level = 0; level <= 5; ++level, quarter *= 4) {
    const TriangleMesh mesh = generate("rough-planet", {{"level", level}});
    EXPECT_EQ(mesh.vertex_count(), 4 * quarter + 2);
    EXPECT_EQ(mesh.triangle_count(), 8 * quarter);
    expect_closed(mesh, 1);
  }
}

TEST(RoughPlanet, StaysWithinItsAmplitudeAndFacesOutward) {
  const TriangleMesh mesh = generate("rough-planet", {{"level", 6}, {"amplitude", 0.05}});
  double lowest = 2.0;
  double highest = 0.0;
  for (const glm::vec3& p : mesh.positions) {
    lowest = std::min(lowest, glm::length(glm::dvec3(p)));
    highest = std::max(highest, glm::length(glm::dvec3(p)));
  }
  EXPECT_GE(lowest, 0.95 - 1e-6);
  EXPECT_LE(highest, 1.05 + 1e-6);
  EXPECT_GT(highest - lowest, 0.03);  // it is rough
  // The surface is a graph over the sphere: every triangle sees the centre from behind.
  for (const Triangle& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]);
    EXPECT_GT(glm::dot(a, glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a)), 0.0);
  }
}

// The warp of the lattice: areas differ by sqrt(3) in the limit, between face centres and octahedron corners.
TEST(RoughPlanet, HasEvenTrianglesWithoutNoise) {
  const TriangleMesh mesh = generate("rough-planet", {{"level", 6}, {"amplitude", 0.0}});
  double smallest = 1.0;
  double largest = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]);
    const double area =
        glm::length(glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a));
    smallest = std::min(smallest, area);
    largest = std::max(largest, area);
  }
  EXPECT_LT(largest / smallest, 1.8);
}

TEST(RoughPlanet, DependsOnTheSeedOnly) {
  const auto positions = [](std::uint64_t seed) {
    return generate("rough-planet", {{"level", 4}, {"seed", seed}}).positions;
  };
  EXPECT_EQ(positions(1), positions(1));
  EXPECT_NE(positions(1), positions(2));
}

TEST(City, IsMadeOfClosedBoxes) {
  const TriangleMesh mesh = generate("city", {{"blocks", 3}, {"facade_cells", 4}, {"seed", 2}});
  expect_closed(mesh, 1 + 4 * 9);  // the ground and four buildings a block
  for (const TriangleMesh& part : split(mesh)) EXPECT_GT(signed_volume(part), 0.0);
  // The ground has 6 x 6 x 1 cells: 2 * 2 * (36 + 6 + 6) triangles; a building 6 sides of 2 * 4^2.
  EXPECT_EQ(mesh.triangle_count(), 192u + 36u * 6u * 32u);
  const auto below_zero = [](const glm::vec3& p) { return p.z < -4.0f; };
  EXPECT_TRUE(std::none_of(mesh.positions.begin(), mesh.positions.end(), below_zero));
}

TEST(City, WorksWithOneCell) { expect_closed(generate("city", {{"blocks", 1}, {"facade_cells", 1}}), 5); }

TEST(Pipes, AreClosedAndInTheUnitCube) {
  const TriangleMesh mesh = generate("pipes", {{"pipes", 20}, {"bends", 9}, {"sides", 7}, {"seed", 3}});
  expect_closed(mesh, 20);
  // A pipe has bends + 1 rings and two centres; two triangles for each side of each piece and one for each side of a
  // cap.
  EXPECT_EQ(mesh.vertex_count(), 20u * (10u * 7u + 2u));
  EXPECT_EQ(mesh.triangle_count(), 20u * (2u * 9u * 7u + 2u * 7u));
  for (const TriangleMesh& part : split(mesh)) EXPECT_GT(signed_volume(part), 0.0);
  for (const glm::vec3& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(p[axis], 0.0f);
      EXPECT_LE(p[axis], 1.0f);
    }
  }
}

TEST(Pipes, OneStraightPipeHasTheVolumeOfAPrism) {
  // A regular n-gon of radius r has area n/2 r^2 sin(2 pi / n); r lies in [0.003, 0.009] and the length in [2/48,
  // 16/48].
  const double volume = signed_volume(generate("pipes", {{"pipes", 1}, {"bends", 1}, {"sides", 4}}));
  EXPECT_GT(volume, 2.0 * 0.003 * 0.003 * 2.0 / 48.0 * 0.999);
  EXPECT_LT(volume, 2.0 * 0.009 * 0.009 * 16.0 / 48.0 * 1.001);
}

// Floors and walls have an outside, an inside that doors and the shaft connect, and nothing else; two bundles a bay.
TEST(Plant, IsOneClosedStructureAndPipesBesideTheAisle) {
  const TriangleMesh mesh =
      generate("plant", {{"storeys", 2}, {"bays", 3}, {"pipes", 4}, {"bends", 5}, {"sides", 6}, {"seed", 7}});
  expect_closed(mesh, 2 + 2 * 3 * 2 * 4);
  // The structure comes first, then pipes of 5 * 6 sides and two caps, with 6 rings and two centres.
  constexpr std::size_t pipes = 2 * 3 * 2 * 4, pipe_triangles = 2 * 5 * 6 + 2 * 6, pipe_vertices = 6 * 6 + 2;
  TriangleMesh structure = mesh;
  structure.triangles.resize(mesh.triangle_count() - pipes * pipe_triangles);
  // 16.2 x 13.6 x 10.9 m, less six rooms, four doors and the hole of the shaft.
  const double solid = 16.2 * 13.6 * 10.9 - 6.0 * 5.0 * 13.0 * 5.0 - 4.0 * 0.3 * 1.2 * 2.2 - 5.0 * 3.0 * 0.3;
  EXPECT_NEAR(signed_volume(structure), solid, 1e-3);
  for (std::size_t v = mesh.vertex_count() - pipes * pipe_vertices; v < mesh.vertex_count(); ++v)
    EXPECT_TRUE(mesh.positions[v].y < 5.3F || mesh.positions[v].y > 8.3F) << mesh.positions[v].y;
}

// The aisle is free from one end to the other, and up the shaft.
TEST(Plant, CanBeWalkedThrough) {
  const TriangleMesh mesh = generate("plant", {{"storeys", 2}, {"bays", 3}, {"pipes", 4}, {"bends", 5}, {"sides", 6}});
  const auto blocks = [&](const glm::vec3& a, const glm::vec3& b) {
    return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
      const glm::vec3 &p = mesh.positions[t.x], &q = mesh.positions[t.y], &r = mesh.positions[t.z];
      const auto side = [&](const glm::vec3& u, const glm::vec3& v) {
        return glm::dot(glm::cross(u - a, v - a), b - a) > 0.0F;
      };
      const glm::vec3 normal = glm::cross(q - p, r - p);
      return side(p, q) == side(q, r) && side(q, r) == side(r, p) &&
             glm::dot(normal, a - p) * glm::dot(normal, b - p) < 0.0F;
    });
  };
  const glm::vec3 begin(0.5F, 6.8F, 2.0F), end(13.7F, 6.8F, 2.0F), upstairs(13.7F, 6.8F, 7.0F);
  EXPECT_FALSE(blocks(begin, end));
  EXPECT_FALSE(blocks(end, upstairs));
  EXPECT_TRUE(blocks(begin + glm::vec3(0, 0, 1), end + glm::vec3(0, 0, 1)));  // above the doors
  EXPECT_TRUE(blocks(begin, glm::vec3(begin.x, begin.y, 7.0F)));              // through the floor
}

TEST(SpheresBehindWall, HidesTheSpheresBehindAClosedWall) {
  const TriangleMesh mesh = generate("spheres-behind-wall", {{"spheres", 10}, {"level", 2}, {"wall_cells", 3}});
  expect_closed(mesh, 11);
  const std::vector<TriangleMesh> parts = split(mesh);
  ASSERT_EQ(parts.size(), 11u);
  for (const TriangleMesh& part : parts) EXPECT_GT(signed_volume(part), 0.0);
  const auto wall_front = [](const glm::vec3& p) { return p.x == 0.0f; };
  EXPECT_EQ(std::count_if(mesh.positions.begin(), mesh.positions.end(), wall_front), 16);  // (3 + 1)^2
  for (std::size_t i = 1; i < parts.size(); ++i) {
    EXPECT_EQ(parts[i].vertex_count(), 66u);  // 4^3 + 2
    for (const glm::vec3& p : parts[i].positions) {
      EXPECT_LT(p.x, -0.05f);  // behind the wall's back
      EXPECT_LT(std::max(std::abs(p.y), std::abs(p.z)), 1.0f);
    }
  }
}

// Returns what is wrong with a call, as its error says it.
std::string mistake(const char* generator, const GeneratorValues& values) {
  try {
    static_cast<void>(generate(generator, values));
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Generators, RefuseOptionsOutOfRange) {
  EXPECT_NE(mistake("rough-planet", {{"level", 12}}), "");
  EXPECT_NE(mistake("rough-planet", {{"level", -1}}), "");
  EXPECT_NE(mistake("rough-planet", {{"amplitude", std::numeric_limits<double>::quiet_NaN()}}), "");
  EXPECT_NE(mistake("city", {{"blocks", 0}}), "");
  EXPECT_NE(mistake("city", {{"blocks", 256}, {"facade_cells", 256}}), "");
  EXPECT_NE(mistake("pipes", {{"sides", 2}}), "");
  EXPECT_NE(mistake("plant", {{"storeys", 0}}), "");
  EXPECT_NE(mistake("plant", {{"pipes", 10'000}, {"bends", 100'000}}), "");
  EXPECT_NE(mistake("spheres-behind-wall", {{"level", 9}}), "");
  EXPECT_NE(mistake("spheres-behind-wall", {{"spheres", 1'000'000}, {"level", 8}}), "");
}

TEST(Generators, SayWhatTheyTake) {
  EXPECT_EQ(mistake("city", {{"blocks", 1.5}}),
            "city: option blocks: 1.5 is out of range; choose a whole number from 1 to 256");
  EXPECT_EQ(mistake("city", {{"level", 1}}),
            "city: option level: is not known; use one of: blocks, facade_cells, seed");
  EXPECT_NE(mistake("village", {}).find("use one of: rough-planet, city, pipes, plant, spheres-behind-wall"),
            std::string::npos);
  // 2^53 + 1 is 2^53 as a double: no larger number passes for another seed.
  EXPECT_EQ(mistake("city", {{"blocks", 1}, {"seed", 0x1p53 - 1}}), "");
  EXPECT_EQ(mistake("city", {{"blocks", 1}, {"seed", (std::uint64_t{1} << 53U) + 1}}),
            "city: option seed: 9007199254740992 is out of range; choose a whole number from 0 to 9007199254740991");
}

TEST(Generators, TakeTheirOwnDefaults) {
  for (const Generator& generator : generators())
    for (const GeneratorParameter& parameter : generator.parameters)
      EXPECT_TRUE(parameter.accepts(parameter.default_value)) << generator.name << " " << parameter.name;
}

// All parts, one after the other, without the vertices that repeat others.
TriangleMesh joined(const std::function<void(const PartVisitor& visit)>& parts, std::size_t& count) {
  TriangleMesh mesh;
  count = 0;
  parts([&](const TriangleMesh& part, std::size_t repeated) {
    const auto first = static_cast<VertexId>(mesh.vertex_count() - repeated);
    for (std::size_t v = 0; v < part.vertex_count(); ++v) {
      if (v >= repeated)
        mesh.positions.push_back(part.positions[v]);
      else
        EXPECT_EQ(part.positions[v], mesh.positions[first + v]);
    }
    for (const Triangle& t : part.triangles) mesh.triangles.push_back(t + first);
    ++count;
  });
  return mesh;
}

void expect_parts(const char* generator, const GeneratorValues& values, std::size_t least) {
  std::size_t count = 0;
  const TriangleMesh parts =
      joined([&](const PartVisitor& visit) { stream_generated(generator, values, visit); }, count);
  const TriangleMesh whole = generate(generator, values);
  EXPECT_EQ(parts.positions, whole.positions);
  EXPECT_EQ(parts.triangles, whole.triangles);
  EXPECT_GE(count, least);
}

TEST(Generated, PartsAreTheWhole) {
  expect_parts("rough-planet", {{"level", 9}}, 4);
  expect_parts("rough-planet", {{"level", 0}}, 1);
  expect_parts("city", {}, 3);
  expect_parts("city", {{"blocks", 1}}, 1);
  expect_parts("pipes", {{"pipes", 1500}}, 2);
  expect_parts("plant", {{"storeys", 1}, {"bays", 2}}, 2);
  expect_parts("spheres-behind-wall", {{"spheres", 300}}, 2);
}

}  // namespace
}  // namespace occlod
