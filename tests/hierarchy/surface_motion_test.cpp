#include "splits/surface_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "occlod/build_hierarchy.h"
#include "splits/star.h"
#include "support/meshes.h"

namespace occlod {
namespace {

// Calls visit(FaceRef, Triangle) for each face that ever existed.
template <typename Visit>
void for_each_face(const Hierarchy& hierarchy, const Visit& visit) {
  for (std::uint32_t slot = 0; slot < hierarchy.base_triangle_count(); ++slot)
    visit(FaceRef{no_id, slot}, hierarchy.data().base_faces[slot]);
  for (SplitId s = 0; s < hierarchy.split_count(); ++s)
    for (std::uint32_t slot = 0; slot < star_of(hierarchy, s).inserted_count(); ++slot)
      visit(FaceRef{s, slot}, star_of(hierarchy, s).inserted(slot));
}

// A face that no collapse has made is of the input.
TEST(SurfaceMotion, TheInputHasNotMoved) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(3, 1));
  const SurfaceMotion motion(hierarchy);
  std::size_t moved = 0, unmoved = 0;
  for_each_face(hierarchy,
                [&](const FaceRef& ref, const Triangle&) { (motion.moved(ref) > 0.0F ? moved : unmoved) += 1; });
  EXPECT_EQ(unmoved, hierarchy.input_triangle_count());
  EXPECT_EQ(moved + unmoved, hierarchy.face_count());
}

// While a plane keeps its straight outline, nothing leaves its place: not by heights, and borders slide along
// themselves. Only when corners of the square go do points move; and they are the last of all.
TEST(SurfaceMotion, APlaneDoesNotMove) {
  const Hierarchy hierarchy = build_hierarchy(test::grid(16, 16), {.base_triangles = 2});
  ASSERT_EQ(hierarchy.base_triangle_count(), 2U);
  const SurfaceMotion motion(hierarchy);
  for_each_face(hierarchy, [&](const FaceRef& ref, const Triangle&) { EXPECT_LT(motion.moved(ref), 1e-5F); });
  EXPECT_EQ(motion.topology_changes(), 0U);
}

// Along every path from a face of the input to one that stands for it motion only grows, and by no more than the
// length of the edge that is collapsed.
TEST(SurfaceMotion, GrowsByNoMoreThanTheEdge) {
  for (const TriangleMesh& mesh : {test::noisy_sphere(3, 2), test::torus(24, 12), test::two_components()}) {
    const Hierarchy hierarchy = build_hierarchy(mesh);
    const SurfaceMotion motion(hierarchy);
    for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
      const SplitStar star = star_of(hierarchy, s);
      float before = 0.0F;
      for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot)
        before = std::max(before, motion.moved({s, slot}));
      const float edge =
          glm::distance(hierarchy.positions()[star.vertex()], hierarchy.positions()[star.parent_vertex()]);
      star.for_each_removed_ref([&](const FaceRef& ref) {
        EXPECT_GE(motion.moved(ref), before);
        EXPECT_LE(motion.moved(ref), (before + edge) * 1.01F);
      });
    }
  }
}

// A ball keeps its topology down to a tetrahedron. A torus cannot: something has to close its hole, and whatever is
// left of that is marked.
TEST(SurfaceMotion, TopologyChangesAreMarked) {
  const SurfaceMotion ball(build_hierarchy(test::noisy_sphere(3, 1), {.base_triangles = 4}));
  EXPECT_EQ(ball.topology_changes(), 0U);
  const Hierarchy torus = build_hierarchy(test::torus(24, 12), {.base_triangles = 4});
  const SurfaceMotion motion(torus);
  EXPECT_GT(motion.topology_changes(), 0U);
  bool any = false;
  for (const SplitId root : torus.data().roots)
    any = any || motion.is_marked(star_of(torus, root).parent_vertex(), root);
  EXPECT_TRUE(any);
}

// What a window leaves when it closes: some vertex of its outline that is still there is marked in every cut that has
// closed it.
TEST(SurfaceMotion, AClosedWindowIsMarked) {
  TriangleMesh mesh = test::grid(12, 12);
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const glm::vec3 middle = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0F;
    return std::max(std::abs(middle.x - 0.5F), std::abs(middle.y - 0.5F)) < 1.0F / 12.0F;
  });
  std::vector<bool> used(mesh.positions.size(), false);
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) used[t[k]] = true;
  mesh.triangles.erase(
      std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) { return !used[t.x]; }),
      mesh.triangles.end());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    if (!used[v]) mesh.positions[v] = mesh.positions[0];
  const Hierarchy hierarchy = build_hierarchy(mesh, {.base_triangles = 2});
  EXPECT_GT(SurfaceMotion(hierarchy).topology_changes(), 0U);
}

TEST(SurfaceMotion, MeasuredBoundsDoNotChangeIt) {
  const TriangleMesh mesh = test::noisy_sphere(4, 6);
  const Hierarchy accumulated = build_hierarchy(mesh),
                  measured = build_hierarchy(mesh, {.error_bound = ErrorBound::measured});
  const SurfaceMotion a(accumulated), b(measured);
  ASSERT_EQ(accumulated.split_count(), measured.split_count());
  for_each_face(accumulated, [&](const FaceRef& ref, const Triangle&) { EXPECT_EQ(a.moved(ref), b.moved(ref)); });
}

TEST(SurfaceMotion, IsShared) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(2, 1));
  const Hierarchy copy = hierarchy;
  const auto first = motion_of(hierarchy), second = motion_of(copy);
  EXPECT_EQ(first.get(), second.get());
}

}  // namespace
}  // namespace occlod
