// What occlod/simplify.h promises.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
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

// By another way than the library's: the least over a fine grid of points of each triangle.
double distance_to(const glm::vec3& p, const TriangleMesh& mesh) {
  constexpr int steps = 12;
  float least2 = std::numeric_limits<float>::infinity();
  for (const Triangle& t : mesh.triangles) {
    const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j) {
        const glm::vec3 off =
            a + (static_cast<float>(i) * (b - a) + static_cast<float>(j) * (c - a)) / float{steps} - p;
        least2 = std::min(least2, glm::dot(off, off));
      }
  }
  return std::sqrt(least2);
}

double rms_distance(const TriangleMesh& from, const TriangleMesh& to) {
  double sum = 0.0;
  for (const glm::vec3& p : from.positions) sum += std::pow(distance_to(p, to), 2.0);
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
  const TriangleMesh mesh = test::torus(60, 40);
  SimplifyOptions options;
  const TriangleMesh moved = simplify(mesh, 300, options);
  options.refit = false;
  const TriangleMesh kept = simplify(mesh, 300, options);
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

TEST(Reduce, SeamsStayAndCornersKeepTheirTexture) {
  const TriangleMesh mesh = test::cylinder_with_seam(64, 32);
  const TriangleMesh reduced = simplify(mesh, 400);
  ASSERT_LE(reduced.triangle_count(), 400U);
  ASSERT_EQ(reduced.texture_coordinates.size(), reduced.wedge_count());
  ASSERT_FALSE(reduced.extra_wedges.empty());
  const std::set<Position> before = positions_of(mesh);
  for (const VertexId v : reduced.extra_wedges) EXPECT_TRUE(before.contains(key(reduced.positions[v])));
  std::set<std::pair<float, float>> texture;
  for (const glm::vec2& t : mesh.texture_coordinates) texture.insert({t.x, t.y});
  for (const glm::vec2& t : reduced.texture_coordinates) EXPECT_TRUE(texture.contains({t.x, t.y}));
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
      const TriangleMesh reduced = simplify(mesh, most);
      EXPECT_LE(reduced.triangle_count(), most);
      for (const glm::vec3& p : reduced.positions)
        EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    }
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
