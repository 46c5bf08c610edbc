// Coordinates at the ends of what floats hold. Where arithmetic is exact, a copy that is moved or scaled refines to the
// same triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <tuple>

#include "hierarchy/hard_geometry.h"
#include "occlod/base.h"
#include "occlod/mesh.h"
#include "splits/spatial_order.h"
#include "support/meshes.h"

namespace occlod {
namespace {

using test::build_soundly;

// A terrain of 40 x 40 cells whose coordinates are whole numbers below 256: any of them, times a power of two or moved
// by a few thousand, is exact.
TriangleMesh terrain() {
  TriangleMesh mesh = test::grid(40, 40);
  std::mt19937 random(3);
  for (glm::vec3& p : mesh.positions)
    p = {std::round(160.0F * p.x), std::round(160.0F * p.y), static_cast<float>(random() % 12)};
  return mesh;
}

template <typename Map>
TriangleMesh mapped(TriangleMesh mesh, const Map& map) {
  for (glm::vec3& p : mesh.positions) p = map(p);
  return mesh;
}

using Corner = std::tuple<float, float, float>;
using TriangleSet = std::multiset<std::array<Corner, 3>>;

// The triangles of the cut with so many, by their corners moved by `map`, from the smallest corner on.
template <typename Map>
TriangleSet cut_set(const Hierarchy& hierarchy, std::size_t triangles, const Map& map) {
  TriangleSet set;
  for (const Triangle& t : triangles_of(hierarchy, cut_to_triangles(hierarchy, triangles))) {
    std::array<Corner, 3> corners;
    for (int i = 0; i < 3; ++i) {
      const glm::vec3 p = map(hierarchy.positions()[t[i]]);
      corners[static_cast<std::size_t>(i)] = {p.x, p.y, p.z};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    set.insert(corners);
  }
  return set;
}

// The same splits in the same order, so the same triangles at every size; `there` is exact.
template <typename Map>
void expect_the_same_cuts(const TriangleMesh& mesh, const Map& there) {
  const Hierarchy original = build_soundly(mesh), copy = build_soundly(mapped(mesh, there));
  const auto stay = [](const glm::vec3& p) { return p; };
  for (const std::size_t triangles : {10U, 100U, 1000U})
    EXPECT_EQ(cut_set(original, triangles, there), cut_set(copy, triangles, stay)) << triangles;
}

TEST(HardCoordinates, PowersOfTwoScaleExactly) {
  // 2^33 and 2^-47 times some 150 make 1e12 and 1e-12.
  const TriangleMesh mesh = terrain();
  for (const int power : {1, 33, -47})
    expect_the_same_cuts(mesh, [&](const glm::vec3& p) { return std::ldexp(1.0F, power) * p; });
}

TEST(HardCoordinates, ErrorsScaleWithTheMesh) {
  // Added up or measured: what is promised of a mesh 2^n times as large is 2^n times as much, exactly, up to where its
  // largest coordinates, 160 * 2^n, and its smallest errors leave what is taken.
  const TriangleMesh mesh = terrain();
  for (const ErrorBound kind : {ErrorBound::accumulated, ErrorBound::measured}) {
    BuildOptions options;
    options.error_bound = kind;
    const Hierarchy unit = build_hierarchy(mesh, options);
    for (const int power : {33, -47, 116, -70}) {
      const float scale = std::ldexp(1.0F, power);
      const Hierarchy copy = build_hierarchy(mapped(mesh, [&](const glm::vec3& p) { return scale * p; }), options);
      ASSERT_EQ(unit.split_count(), copy.split_count());
      std::size_t different = 0;
      for (SplitId s = 0; s < unit.split_count(); ++s) {
        different += scale * unit.node(s).error != copy.node(s).error ? 1U : 0U;
        different += scale * unit.node(s).guaranteed_error != copy.node(s).guaranteed_error ? 1U : 0U;
      }
      EXPECT_EQ(different, 0U) << "2^" << power;
    }
  }
}

TEST(HardCoordinates, MovedByWholeNumbers) {
  expect_the_same_cuts(terrain(), [](const glm::vec3& p) { return p + glm::vec3(4096, -2048, 65536); });
}

TEST(HardCoordinates, UtmMetres) {
  // Half metres at 500,000 east and 4,000,000 north: floats there are 1/32 and 1/4 apart, so the copy is exact.
  const TriangleMesh mesh = mapped(terrain(), [](const glm::vec3& p) { return 0.5F * p; });
  expect_the_same_cuts(mesh, [](const glm::vec3& p) { return p + glm::vec3(500'000, 4'000'000, 300); });
}

TEST(HardCoordinates, UtmMetresAfterRounding) {
  // A centimetre grid there is rounded to steps of 1/32 and 1/4 m: vertices coincide, triangles become lines. What is
  // left after cleaning builds.
  TriangleMesh mesh = test::grid(60, 60);
  for (glm::vec3& p : mesh.positions)
    p = {500'000.0F + 3.0F * p.x, 4'000'000.0F + 3.0F * p.y, 300.0F + std::sin(9.0F * p.x)};
  CleanMesh rounded = clean(mesh, {}, "terrain");
  EXPECT_GT(rounded.report.vertices_welded, 0U);
  EXPECT_GT(rounded.report.repeated_index_triangles, 0U);
  (void)build_soundly(rounded.mesh);
}

TEST(HardCoordinates, TurnedByARightAngleIsAsGood) {
  // Exact, but neighbours come in another order, so ties fall otherwise: errors at each size are alike, not equal.
  const TriangleMesh mesh = test::noisy_sphere(5, 1);
  const Hierarchy original = build_soundly(mesh);
  const Hierarchy turned = build_soundly(mapped(mesh, [](const glm::vec3& p) { return glm::vec3(-p.y, p.x, p.z); }));
  for (const std::size_t triangles : {200U, 1000U, 4000U}) {
    const float a = cut_to_triangles(original, triangles).error, b = cut_to_triangles(turned, triangles).error;
    EXPECT_NEAR(a, b, 0.1F * a) << triangles;
  }
}

TEST(HardCoordinates, AspectRatioOfAMillion) {
  const TriangleMesh mesh = test::noisy_sphere(4, 1);
  (void)build_soundly(mapped(mesh, [](const glm::vec3& p) { return p * glm::vec3(1e6F, 1, 1); }));
  (void)build_soundly(mapped(mesh, [](const glm::vec3& p) { return p * glm::vec3(1, 1, 1e-6F); }));
}

TEST(HardCoordinates, EndsOfTheRange) {
  // The largest floats are 3.4e38; squares of coordinates beyond 1.8e19, and of those below 1e-23, leave the range.
  const TriangleMesh mesh = test::noisy_sphere(3, 1);
  for (const float scale : {1e18F, 1e25F, 1e37F, 1e-20F, 1e-30F, 1e-37F}) {
    SCOPED_TRACE(scale);
    (void)build_soundly(mapped(mesh, [&](const glm::vec3& p) { return scale * p; }));
  }
}

// The diagonal of a cube of half side 1.5e37 is 5.2e37 long, of which six times is a float; of 2e38 not even once.
TEST(HardCoordinates, CornersOfTheRangeBuildAndWhatIsBeyondIsRefused) {
  const TriangleMesh mesh = test::noisy_sphere(3, 1);
  const auto to_corners = [](float far) {
    return [far](const glm::vec3& p) {
      return glm::vec3(std::copysign(far, p.x), std::copysign(far, p.y), far * std::clamp(p.z, -1.0F, 1.0F));
    };
  };
  (void)build_soundly(clean(mapped(mesh, to_corners(1.5e37F)), {}, "corners").mesh);
  for (const float far : {1.6e37F, 2e38F, 3.4e38F})
    EXPECT_THROW((void)build_hierarchy(mapped(mesh, to_corners(far))), Error) << far;
}

TEST(HardCoordinates, Denormals) {
  // Below 1.2e-38 floats are multiples of 1.4e-45: a sphere of 1e-40 has some 70,000 steps across its radius, one of
  // 1e-43 some 70, of which many vertices share places.
  const TriangleMesh mesh = test::noisy_sphere(3, 1);
  for (const double scale : {1e-40, 1e-43, 3e-45}) {
    SCOPED_TRACE(scale);
    const TriangleMesh tiny =
        mapped(mesh, [&](const glm::vec3& p) { return glm::vec3(scale * p.x, scale * p.y, scale * p.z); });
    (void)build_soundly(clean(tiny, {}, "sphere").mesh);
  }
}

TEST(HardCoordinates, DenormalExtentIsOneCell) {
  // 1024 cells in an extent of 1e-44 are more cells a unit than a float can count: infinitely many, and none of 0.
  const std::vector<glm::vec3> positions = {{1.4e-44F, 0, 0}, {0, 0, 0}, {0, 1e-44F, 0}};
  std::vector<VertexId> vertices = {2, 0, 1};
  sort_spatially(positions, {bounding_box(positions), glm::dvec3(0.0), 10}, vertices, 1);
  EXPECT_EQ(vertices, (std::vector<VertexId>{2, 0, 1}));  // all in one cell, so as they came
}

TEST(HardCoordinates, DenormalsBesideLargeOnes) {
  // A sphere of 1e-40 and one of 1e30 in one mesh: the small one is a point beside the other, and there when all is
  // refined.
  TriangleMesh mesh = mapped(test::noisy_sphere(2, 1), [](const glm::vec3& p) { return 1e30F * p; });
  const TriangleMesh tiny = mapped(test::noisy_sphere(2, 2),
                                   [](const glm::vec3& p) { return glm::vec3(1e-40 * p.x, 1e-40 * p.y, 1e-40 * p.z); });
  test::append(mesh, tiny, {});
  (void)build_soundly(clean(mesh, {}, "spheres").mesh);
}

}  // namespace
}  // namespace occlod
