#include "objects.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "raster/depth_pyramid.h"

namespace occlod::viewer {
namespace {

double difference(const glm::dmat4& a, const glm::dmat4& b) {
  double most = 0.0;
  for (int i = 0; i < 4; ++i) most = std::max(most, glm::length(a[i] - b[i]));
  return most;
}

TEST(Placement, ComesBackFromItsMatrix) {
  for (const glm::dvec3& angles : {glm::dvec3(0.0), glm::dvec3(10.0, 20.0, 30.0), glm::dvec3(-170.0, 60.0, 179.0),
                                   glm::dvec3(0.0, 90.0, 35.0), glm::dvec3(40.0, -90.0, 0.0)}) {
    const Placement placement{{1.0, -2.0, 3.0}, angles, 2.5, glm::dmat3(1.0)};
    const glm::dmat4 matrix = matrix_of(placement);
    const Placement found = placement_of(matrix);
    EXPECT_NEAR(found.scale, 2.5, 1e-9);
    EXPECT_EQ(found.shape, glm::dmat3(1.0));
    // Angles at the poles are not unique; what they make of it is.
    EXPECT_LT(difference(matrix_of(found), matrix), 1e-9);
  }
}

// 90 degrees around z take x to y.
TEST(Placement, TurnsCounterClockwise) {
  const glm::dmat4 matrix = matrix_of({glm::dvec3(0.0), {0.0, 0.0, 90.0}, 1.0, glm::dmat3(1.0)});
  EXPECT_LT(glm::length(glm::dvec3(matrix * glm::dvec4(1.0, 0.0, 0.0, 1.0)) - glm::dvec3(0.0, 1.0, 0.0)), 1e-12);
}

TEST(Placement, KeepsWhatIsNoRotation) {
  glm::dmat4 shear(1.0);
  shear[1][0] = 0.5;
  const Placement placement = placement_of(shear);
  EXPECT_EQ(placement.rotation_deg, glm::dvec3(0.0));
  EXPECT_EQ(difference(matrix_of(placement), shear), 0.0);
}

TEST(ViewMesh, HasUnitNormalsOutwardsAndLevelsByParents) {
  const auto hierarchy = std::make_shared<const Hierarchy>(build_hierarchy(generate("rough-planet", {{"level", 3}})));
  const auto mesh = make_view_mesh(hierarchy);
  ASSERT_EQ(mesh->normals.size(), hierarchy->vertex_count());
  for (std::size_t i = 0; i < mesh->normals.size(); ++i) {
    EXPECT_NEAR(glm::length(mesh->normals[i]), 1.0F, 1e-5F);
    EXPECT_GT(glm::dot(mesh->normals[i], glm::normalize(hierarchy->positions()[i])), 0.0F);  // a planet around 0
  }
  for (SplitId s = 0; s < hierarchy->split_count(); ++s) {
    const SplitId parent = hierarchy->node(s).parent;
    EXPECT_EQ(mesh->levels[s], parent == no_id ? 0 : mesh->levels[parent] + 1);
  }
}

// A sphere of radius 1 fits a planet of radius 1 to within its hills; the corners of its box are 1.7 away.
TEST(SceneBounds, FitsTheVerticesAndTheirPlacement) {
  PlacedObject object;
  object.mesh =
      make_view_mesh(std::make_shared<const Hierarchy>(build_hierarchy(generate("rough-planet", {{"level", 3}}))));
  object.placement = {{1.0, 2.0, 3.0}, {10.0, 20.0, 30.0}, 2.0, glm::dmat3(1.0)};
  object.object_to_world = matrix_of(object.placement);
  for (const SceneBounds& bounds : {bounds_of(object), bounds_of(Objects{object})}) {
    EXPECT_LT(bounds.radius, 2.0 * 1.15);
    for (const glm::vec3& p : object.mesh->hierarchy->positions())
      EXPECT_LE(glm::distance(glm::dvec3(object.object_to_world * glm::dvec4(p, 1.0)), bounds.center),
                bounds.radius + 1e-5);
  }
}

TEST(SceneBounds, LeavesOutWhatIsNotShown) {
  const auto mesh =
      make_view_mesh(std::make_shared<const Hierarchy>(build_hierarchy(generate("rough-planet", {{"level", 2}}))));
  PlacedObject here, there;
  here.mesh = there.mesh = mesh;
  there.object_to_world[3] = glm::dvec4(100.0, 0.0, 0.0, 1.0);
  EXPECT_GT(bounds_of(Objects{here, there}).radius, 50.0);
  there.shown = false;
  EXPECT_LT(bounds_of(Objects{here, there}).radius, 3.0);
  EXPECT_EQ(bounds_of(Objects{}).radius, 1.0);
}

}  // namespace
}  // namespace occlod::viewer
