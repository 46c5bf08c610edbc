// What occlod/simplify.h promises.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "occlod/base.h"
#include "occlod/simplify.h"
#include "support/meshes.h"
#include "support/wedge_meshes.h"

namespace occlod {
namespace {

using Position = std::tuple<float, float, float>;

Position key(const glm::vec3& p) { return {p.x, p.y, p.z}; }

std::set<Position> positions_of(const TriangleMesh& mesh) {
  std::set<Position> result;
  for (const glm::vec3& p : mesh.positions) result.insert(key(p));
  return result;
}

double distance_to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0.0 ? std::min(std::max(glm::dot(p - a, along) / length2, 0.0), 1.0) : 0.0;
  return glm::distance(p, a + t * along);
}

// By another way than the library's: the least over the sides, and over the inside where the point lies over it.
double distance_to(const glm::dvec3& p, const TriangleMesh& mesh) {
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& t : mesh.triangles) {
    const glm::dvec3 c[] = {mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
    const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
    bool is_over = glm::dot(normal, normal) > 0.0;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 &from = c[k], &to = c[(k + 1) % 3];
      least = std::min(least, distance_to_segment(p, from, to));
      is_over = is_over && glm::dot(glm::cross(to - from, p - from), normal) >= 0.0;
    }
    if (is_over) least = std::min(least, std::abs(glm::dot(p - c[0], glm::normalize(normal))));
  }
  return least;
}

double rms_distance(const TriangleMesh& from, const TriangleMesh& to) {
  double sum = 0.0;
  for (const glm::vec3& p : from.positions) sum += std::pow(distance_to(glm::dvec3(p), to), 2.0);
  return std::sqrt(sum / static_cast<double>(from.positions.size()));
}

// Hills on the unit square.
TriangleMesh hills(int cells) {
  TriangleMesh mesh = test::grid(cells, cells);
  for (glm::vec3& p : mesh.positions) p.z = 0.1F * std::sin(9.0F * p.x) * std::cos(7.0F * p.y);
  return mesh;
}

TEST(Reduce, HasAtMostTheTrianglesAskedForAndIsTheSameForAnyThreads) {
  const TriangleMesh mesh = test::noisy_sphere(7, 4);  // several blocks, several passes
  SimplifyOptions options;
  for (const std::size_t most : {mesh.triangle_count() / 3, std::size_t{1000}, std::size_t{100}}) {
    options.threads = 1;
    const TriangleMesh one = simplify(mesh, most, options);
    EXPECT_LE(one.triangle_count(), most);
    EXPECT_GE(one.triangle_count() + 2, most);
    options.threads = 3;
    const TriangleMesh three = simplify(mesh, most, options);
    EXPECT_EQ(one.triangles, three.triangles);
    EXPECT_EQ(one.positions, three.positions);
  }
}

TEST(Reduce, LeavesAMeshThatIsSmallEnoughAsItIs) {
  const TriangleMesh mesh = test::noisy_sphere(2, 4);
  const TriangleMesh same = simplify(mesh, mesh.triangle_count());
  EXPECT_EQ(same.triangles, mesh.triangles);
  EXPECT_EQ(same.positions, mesh.positions);
}

TEST(Reduce, MovedVerticesFitTheSurfaceBetter) {
  const TriangleMesh mesh = test::torus(40, 25);
  SimplifyOptions options;
  const TriangleMesh moved = simplify(mesh, 200, options);
  options.refit = false;
  const TriangleMesh kept = simplify(mesh, 200, options);
  EXPECT_EQ(moved.triangle_count(), kept.triangle_count());
  EXPECT_LT(rms_distance(mesh, moved), 0.8 * rms_distance(mesh, kept));
  const std::set<Position> before = positions_of(mesh);
  for (const glm::vec3& p : kept.positions) EXPECT_TRUE(before.contains(key(p)));
}

TEST(Reduce, BordersStay) {
  const TriangleMesh mesh = hills(40);
  const std::set<Position> before = positions_of(mesh);
  std::size_t on_border = 0, moved = 0;
  for (const glm::vec3& p : simplify(mesh, 200).positions) {
    const bool is_border = p.x == 0.0F || p.x == 1.0F || p.y == 0.0F || p.y == 1.0F;
    on_border += is_border ? 1U : 0U;
    moved += before.contains(key(p)) ? 0U : 1U;
    EXPECT_TRUE(!is_border || before.contains(key(p)));
  }
  EXPECT_GT(on_border, 4U);
  EXPECT_GT(moved, 20U);
}

// Chords lie within a barrel, so vertices on it fit worse than vertices outside, on its seam as elsewhere.
TEST(Reduce, SeamsOfTexturesMoveAlongTheirNormals) {
  TriangleMesh mesh = test::cylinder_with_seam(64, 64);
  const auto radius_at = [](double z) { return 1.0 + 0.5 * std::sin(std::numbers::pi * z / 4.0); };
  for (glm::vec3& p : mesh.positions) {
    const auto radius = static_cast<float>(radius_at(p.z));
    p.x *= radius;
    p.y *= radius;
  }
  const TriangleMesh reduced = simplify(mesh, 400);
  double outside = 0.0;
  std::size_t inner = 0;
  for (const VertexId v : reduced.extra_wedges) {
    const glm::dvec3 p(reduced.positions[v]);
    if (p.z == 0.0 || p.z == 4.0) continue;  // on the border
    ++inner;
    outside += std::hypot(p.x, p.y) - radius_at(p.z);
    EXPECT_LT(std::abs(std::atan2(p.y, p.x)), 0.25 * (2.0 * std::numbers::pi / 64.0));  // of the input's step
  }
  ASSERT_GE(inner, 3U);
  EXPECT_GT(outside / static_cast<double>(inner), 1e-3);
}

TEST(Reduce, CornersKeepTheirTexture) {
  const TriangleMesh mesh = test::cylinder_with_seam(64, 32);
  const TriangleMesh reduced = simplify(mesh, 400);
  ASSERT_LE(reduced.triangle_count(), 400U);
  ASSERT_EQ(reduced.texture_coordinates.size(), reduced.wedge_count());
  ASSERT_FALSE(reduced.extra_wedges.empty());
  std::set<std::pair<float, float>> texture;
  for (const glm::vec2& t : mesh.texture_coordinates) texture.insert({t.x, t.y});
  for (const glm::vec2& t : reduced.texture_coordinates) EXPECT_TRUE(texture.contains({t.x, t.y}));
}

TEST(Reduce, SeamsOfOtherAttributesStay) {
  TriangleMesh mesh = test::cylinder_with_seam(64, 32);
  mesh.texture_coordinates.clear();
  mesh.colors.assign(mesh.wedge_count(), glm::u8vec4(255));
  std::fill(mesh.colors.begin() + static_cast<std::ptrdiff_t>(mesh.vertex_count()), mesh.colors.end(), glm::u8vec4(9));
  const TriangleMesh reduced = simplify(mesh, 400);
  ASSERT_FALSE(reduced.extra_wedges.empty());
  const std::set<Position> before = positions_of(mesh);
  for (const VertexId v : reduced.extra_wedges) EXPECT_TRUE(before.contains(key(reduced.positions[v])));
}

TEST(Reduce, ScaledMeshesGiveTheScaledResult) {
  TriangleMesh mesh = test::noisy_sphere(5, 4);
  const TriangleMesh expected = simplify(mesh, 300);
  for (const int exponent : {-100, -20, 20, 100}) {
    const float scale = std::ldexp(1.0F, exponent);
    TriangleMesh scaled = mesh;
    for (glm::vec3& p : scaled.positions) p *= scale;
    const TriangleMesh reduced = simplify(scaled, 300);
    EXPECT_EQ(reduced.triangles, expected.triangles);
    ASSERT_EQ(reduced.positions.size(), expected.positions.size());
    for (std::size_t v = 0; v < expected.positions.size(); ++v)
      EXPECT_EQ(reduced.positions[v], scale * expected.positions[v]) << exponent;
  }
}

TEST(Reduce, TakesAnyGeometry) {
  for (const TriangleMesh& mesh :
       {test::single_triangle(), test::book(5), test::bow_tie(), test::moebius(20), test::double_sided_quad(),
        test::two_components(), test::many_tetrahedra(50), test::fan(200), test::torus(12, 7),
        test::random_soup_with_wedges(3), test::cube_of_charts(6)})
    for (const std::size_t most : {std::size_t{1}, mesh.triangle_count() / 2 + 1}) {
      TriangleMesh reduced;
      try {
        reduced = simplify(mesh, most);
      } catch (const Error&) {  // nothing is left of closed surfaces
        EXPECT_EQ(most, 1U);
        continue;
      }
      EXPECT_GT(reduced.triangle_count(), 0U);
      EXPECT_LE(reduced.triangle_count(), most);
      for (const glm::vec3& p : reduced.positions)
        EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    }
}

// Points of each triangle and its corners, in their farthest distance from another mesh.
double farthest_of_points(const TriangleMesh& from, const TriangleMesh& to) {
  double farthest = 0.0;
  for (const Triangle& t : from.triangles) {
    const glm::vec3 &a = from.positions[t.x], &b = from.positions[t.y], &c = from.positions[t.z];
    for (const glm::vec3& w : {glm::vec3(1, 1, 1) / 3.0F, glm::vec3(4, 1, 1) / 6.0F, glm::vec3(1, 4, 1) / 6.0F,
                               glm::vec3(1, 1, 4) / 6.0F, glm::vec3(1, 0, 0)})
      farthest = std::max(farthest, distance_to(glm::dvec3(w.x * a + w.y * b + w.z * c), to));
  }
  return farthest;
}

TEST(ReduceWithin, KeepsTheDistanceInBothDirections) {
  for (const TriangleMesh& mesh : {test::torus(40, 25), hills(20)})
    for (const double allowed : {0.05, 0.01}) {
      const SimplifiedMesh reduced = simplify_within(mesh, allowed);
      EXPECT_LT(reduced.mesh.triangle_count(), mesh.triangle_count());
      EXPECT_GT(reduced.distance, 0.3 * allowed);
      EXPECT_LE(reduced.distance, allowed);
      EXPECT_LE(farthest_of_points(mesh, reduced.mesh), 1.001 * allowed);
      EXPECT_LE(farthest_of_points(reduced.mesh, mesh), 1.001 * allowed);
    }
}

// What bisection of simplify()'s number of triangles finds, with distances of many points.
std::size_t fewest_by_bisection(const TriangleMesh& mesh, double allowed) {
  std::size_t too_few = 1, enough = mesh.triangle_count();
  while (enough > too_few + too_few / 50 + 1) {
    const std::size_t n = (too_few + enough) / 2;
    const TriangleMesh reduced = simplify(mesh, n);
    const bool is_near = std::max(farthest_of_points(mesh, reduced), farthest_of_points(reduced, mesh)) <= allowed;
    (is_near ? enough : too_few) = n;
  }
  return enough;
}

TEST(ReduceWithin, NeedsNoMoreTrianglesThanBisectionFinds) {
  for (const TriangleMesh& mesh : {test::torus(24, 16), test::noisy_sphere(4, 4), hills(20)})
    EXPECT_LE(simplify_within(mesh, 0.02).mesh.triangle_count(), fewest_by_bisection(mesh, 0.02) * 11 / 10);
}

// Quadrics let specks vanish early, which would leave the whole mesh as it is.
TEST(ReduceWithin, KeepsASpeckThatIsFarFromTheRest) {
  TriangleMesh mesh = test::torus(40, 25);
  const TriangleMesh torus = mesh;
  const auto first = static_cast<VertexId>(mesh.positions.size());
  for (const glm::vec3& p : {glm::vec3(9, 0, 0), glm::vec3(9.001F, 0, 0), glm::vec3(9, 0.001F, 0)})
    mesh.positions.push_back(p);
  mesh.triangles.push_back({first, first + 1, first + 2});
  const SimplifiedMesh reduced = simplify_within(mesh, 0.02);
  EXPECT_LE(reduced.mesh.triangle_count(), simplify_within(torus, 0.02).mesh.triangle_count() * 5 / 4 + 1);
  EXPECT_LT(distance_to(glm::dvec3(9, 0, 0), reduced.mesh), 0.021);
}

TEST(ReduceWithin, IsTheSameForAnyThreads) {
  const TriangleMesh mesh = test::noisy_sphere(5, 4);
  SimplifyOptions options;
  options.threads = 1;
  const SimplifiedMesh one = simplify_within(mesh, 0.02, options);
  options.threads = 3;
  const SimplifiedMesh three = simplify_within(mesh, 0.02, options);
  EXPECT_EQ(one.mesh.triangles, three.mesh.triangles);
  EXPECT_EQ(one.mesh.positions, three.mesh.positions);
  EXPECT_EQ(one.distance, three.distance);
}

TEST(ReduceWithin, TakesAnyGeometry) {
  for (const TriangleMesh& mesh :
       {test::single_triangle(), test::book(5), test::bow_tie(), test::moebius(20), test::double_sided_quad(),
        test::two_components(), test::many_tetrahedra(50), test::fan(200), test::torus(12, 7),
        test::random_soup_with_wedges(3), test::cube_of_charts(6)})
    for (const double allowed : {1e-6, 0.1, 1e6}) {
      const SimplifiedMesh reduced = simplify_within(mesh, allowed);
      EXPECT_GE(reduced.mesh.triangle_count(), 1U);
      EXPECT_LE(farthest_of_points(reduced.mesh, mesh), 1.001 * allowed + 1e-5);
    }
}

TEST(ReduceWithin, RefusesWhatIsNoDistance) {
  const TriangleMesh mesh = test::tetrahedron();
  for (const double allowed : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")})
    EXPECT_THROW((void)simplify_within(mesh, allowed), Error);
}

TEST(Reduce, ReportsProgressUpToOneAndCanBeCancelled) {
  const TriangleMesh mesh = test::noisy_sphere(6, 4);
  SimplifyOptions options;
  double last = 0.0;
  options.progress = [&](double done) {
    EXPECT_GE(done, last);
    last = done;
    return true;
  };
  (void)simplify(mesh, 1000, options);
  EXPECT_EQ(last, 1.0);
  options.progress = [](double) { return false; };
  EXPECT_THROW((void)simplify(mesh, 1000, options), Error);
}

// A closed surface of fewer than four triangles encloses nothing, so that all of it would be gone.
TEST(Reduce, LeavesSomething) {
  const TriangleMesh mesh = test::noisy_sphere(4, 1);
  EXPECT_EQ(simplify(mesh, 4).triangle_count(), 4U);
  for (const std::size_t most : {1U, 3U}) EXPECT_THROW((void)simplify(mesh, most), Error) << most;
  EXPECT_EQ(simplify(test::fan(200), 1).triangle_count(), 1U);
}

std::string what_of(const TriangleMesh& mesh, std::size_t most) {
  try {
    (void)simplify(mesh, most);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(Reduce, SaysTheFewestTrianglesThatArePossible) {
  const TriangleMesh mesh = test::many_tetrahedra(50);
  EXPECT_NE(what_of(mesh, 3).find("allow more: the fewest are 4"), std::string::npos) << what_of(mesh, 3);
  EXPECT_EQ(simplify(mesh, 4).triangle_count(), 4U);
}

// Tetrahedra of the sizes 1 to 2, in no order.
TriangleMesh tetrahedra_of_sizes(std::size_t count) {
  TriangleMesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    TriangleMesh part = test::tetrahedron();
    for (glm::vec3& p : part.positions) p *= 1.0F + static_cast<float>(i * 617 % count) / static_cast<float>(count);
    test::append(mesh, part, {4.0F * static_cast<float>(i), 0, 0});
  }
  return mesh;
}

// A tetrahedron has no fewer triangles, so a tenth of them stay, and those are the largest. The queue orders costs,
// which go with the cubes of sizes, to 1/32 octave.
TEST(Reduce, PartsVanishSmallestFirst) {
  constexpr std::size_t count = 1000;
  const TriangleMesh reduced = simplify(tetrahedra_of_sizes(count), 4 * count / 10);
  ASSERT_EQ(reduced.triangle_count(), 4 * count / 10);
  for (const Triangle& t : reduced.triangles) {  // each has a side along the diagonal of two of the three axes
    float longest = 0.0F;
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, glm::distance(reduced.positions[t[k]], reduced.positions[t[(k + 1) % 3]]));
    EXPECT_GT(longest / std::sqrt(2.0F), 0.97F * 1.9F);
  }
}

// What vanished is as far from the rest as it was.
TEST(ReduceWithin, CountsTheDistanceOfPartsThatVanish) {
  const TriangleMesh mesh = tetrahedra_of_sizes(50);
  for (const double allowed : {1.0, 10.0}) {
    const SimplifiedMesh reduced = simplify_within(mesh, allowed);
    EXPECT_LE(reduced.distance, allowed);
    EXPECT_LE(farthest_of_points(mesh, reduced.mesh), 1.001 * allowed);
    EXPECT_EQ(reduced.mesh.triangle_count() < mesh.triangle_count(), allowed == 10.0) << allowed;
  }
}

// Double pyramids over a triangle, a hundredth as high as wide: the first collapse of each costs next to nothing, so a
// pass could make them in all blocks at once.
TEST(Reduce, LeavesTheTrianglesAskedForOfManyFlatParts) {
  constexpr int count = 20'000, columns = 141;
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const float size = 0.05F + 0.35F * static_cast<float>(i * 617 % count) / static_cast<float>(count);
    TriangleMesh part = test::fan(3);
    part.positions[0].z = 0.01F;
    part.positions.emplace_back(0.0F, 0.0F, -0.01F);
    for (int side = 0; side < 3; ++side) {
      const Triangle t = part.triangles[static_cast<std::size_t>(side)];
      part.triangles.emplace_back(4U, t.z, t.y);
    }
    for (glm::vec3& p : part.positions) p *= size;
    test::append(mesh, part, {static_cast<float>(i % columns), static_cast<float>(i / columns), 0});
  }
  const std::size_t most = mesh.triangle_count() / 10;
  const std::size_t left = simplify(mesh, most).triangle_count();
  EXPECT_LE(left, most);
  EXPECT_GE(left + 6, most);
}

TEST(Reduce, RefusesWhatItCannotDo) {
  const TriangleMesh mesh = test::tetrahedron();
  EXPECT_THROW((void)simplify(mesh, 0), Error);
  EXPECT_THROW((void)simplify({}, 1), Error);
  SimplifyOptions options;
  options.threads = -1;
  EXPECT_THROW((void)simplify(mesh, 1, options), Error);
}

}  // namespace
}  // namespace occlod
