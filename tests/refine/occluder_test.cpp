#include "refine/occluder.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "refine_support.h"

namespace occlod {
namespace {

constexpr double no_hit = std::numeric_limits<double>::infinity();

// Distance along a ray to the nearest triangle, either side of it (Moeller & Trumbore 1997, in double precision).
double first_hit(const glm::dvec3& eye, const glm::dvec3& ray, std::span<const glm::vec3> positions,
                 std::span<const Triangle> triangles) {
  double nearest = no_hit;
  for (const Triangle& t : triangles) {
    const glm::dvec3 a(positions[t.x]), u = glm::dvec3(positions[t.y]) - a, v = glm::dvec3(positions[t.z]) - a;
    const glm::dvec3 p = glm::cross(ray, v);
    const double det = glm::dot(u, p);
    if (det == 0.0) continue;
    const glm::dvec3 s = eye - a, q = glm::cross(s, u);
    const double x = glm::dot(s, p) / det, y = glm::dot(ray, q) / det, along = glm::dot(v, q) / det;
    if (x >= 0.0 && y >= 0.0 && x + y <= 1.0 && along > 0.0) nearest = std::min(nearest, along);
  }
  return nearest;
}

struct Count {
  int hidden = 0;  // rays on which the occluder hides what is behind it
  int wrong = 0;   // of these, those on which the input has nothing in front of that
};

// Random cuts of a rough ball, looked at from all around.
Count count_wrongly_hidden(OccluderMode mode) {
  const TriangleMesh mesh = test::noisy_sphere(4, 6);
  const Hierarchy hierarchy = build_hierarchy(mesh);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))); };
  Occluder occluder;
  Count count;
  for (int n = 0; n < 12; ++n) {
    std::vector<Cut> cuts;
    cuts.emplace_back(hierarchy);
    for (int i = 0; i < 20 * n; ++i) {
      const auto s = static_cast<SplitId>(random() % hierarchy.split_count());
      if (cuts[0].applied(s)) continue;
      (void)cuts[0].closure(s);
      cuts[0].apply_closure();
    }
    Camera camera;
    camera.eye = 3.0 * direction();
    const std::vector<ObjectView> views = {ObjectView(View(camera), glm::dmat4(1.0))};
    const std::span<const OccluderPart> parts = occluder.build(cuts, views, mode);
    for (int i = 0; i < 60; ++i) {
      const glm::dvec3 ray = glm::normalize(1.05 * direction() - camera.eye);
      const double hit = first_hit(camera.eye, ray, parts[0].positions, parts[0].triangles);
      if (hit == no_hit) continue;
      ++count.hidden;
      if (first_hit(camera.eye, ray, mesh.positions, mesh.triangles) > hit + 1e-6) ++count.wrong;
    }
  }
  return count;
}

// What the occluder hides along a ray has to be behind the input there. Coarse triangles as they are bulge out.
TEST(Occluder, ConservativeHidesOnlyWhatTheInputHides) {
  const Count conservative = count_wrongly_hidden(OccluderMode::conservative);
  EXPECT_EQ(conservative.wrong, 0);
  EXPECT_GT(conservative.hidden, 100);  // and is an occluder still
  EXPECT_GT(count_wrongly_hidden(OccluderMode::paper).wrong, 20);
}

TEST(Occluder, PaperIsTheCutItself) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(3, 1));
  std::vector<Cut> cuts;
  cuts.emplace_back(hierarchy);
  (void)cuts[0].closure(static_cast<SplitId>(hierarchy.split_count() / 2));
  cuts[0].apply_closure();
  const std::vector<ObjectView> views = {ObjectView(View(test::front_camera()), glm::dmat4(1.0))};
  Occluder occluder;
  const std::span<const OccluderPart> parts = occluder.build(cuts, views, OccluderMode::paper);
  std::vector<Triangle> expected;
  cuts[0].active_triangles(expected, true);
  ASSERT_EQ(parts.size(), 1U);
  ASSERT_EQ(parts[0].triangles.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(parts[0].positions[parts[0].triangles[i][k]], hierarchy.positions()[expected[i][k]]);
}

// The full mesh is the input: its error is 0, and its front faces are where they are.
TEST(Occluder, FrontOfTheFullMeshIsNotMoved) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(3, 1));
  std::vector<Cut> cuts;
  cuts.emplace_back(hierarchy);
  for (SplitId s = 0; s < hierarchy.split_count(); ++s)
    if (!cuts[0].applied(s)) {
      (void)cuts[0].closure(s);
      cuts[0].apply_closure();
    }
  const std::vector<ObjectView> views = {ObjectView(View(test::front_camera()), glm::dmat4(1.0))};
  Occluder occluder;
  const std::span<const OccluderPart> parts = occluder.build(cuts, views, OccluderMode::conservative);
  std::vector<glm::vec3> expected;
  std::vector<Triangle> cut;
  cuts[0].active_triangles(cut, true);
  for (const Triangle& t : cut) {
    const glm::vec3 &a = hierarchy.positions()[t.x], &b = hierarchy.positions()[t.y], &c = hierarchy.positions()[t.z];
    if (glm::dot(glm::cross(b - a, c - a), views[0].eye() - a) > 0.0F) expected.insert(expected.end(), {a, b, c});
  }
  EXPECT_TRUE(std::equal(parts[0].positions.begin(), parts[0].positions.end(), expected.begin(), expected.end()));
}

}  // namespace
}  // namespace occlod
