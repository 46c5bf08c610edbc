// Each test fails if its culling test is inverted, left out or too eager.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>

#include "refine/importance.h"
#include "refine/refine_support.h"
#include "refine/tuning.h"
#include "splits/star.h"

namespace occlod {
namespace {

std::size_t splits_of(const Hierarchy& hierarchy, const glm::dmat4& transform, Culling culling,
                      bool two_sided = false) {
  std::array<RefineObject, 1> objects{{{&hierarchy, transform, two_sided}}};
  Refiner refiner(objects);
  NoOcclusion none;
  RefineOptions options;
  options.budget = refiner.full_triangles();
  tune(options).culling = culling;
  return refiner.refine(View(test::front_camera()), options, none).stats.splits;
}

// A bumpy sheet that faces +z everywhere.
const Hierarchy& sheet() {
  static const Hierarchy hierarchy = [] {
    TriangleMesh mesh = test::grid(12, 12);
    for (glm::vec3& p : mesh.positions)
      p = {p.x - 0.5F, p.y - 0.5F, 0.004F * std::sin(40.0F * p.x) * std::cos(33.0F * p.y)};
    BuildOptions options;
    options.base_triangles = 2;
    return build_hierarchy(mesh, options);
  }();
  return hierarchy;
}

class CullingTest : public ::testing::TestWithParam<Culling> {};

TEST_P(CullingTest, FrustumKeepsWhatIsInsideAndDropsWhatIsOutside) {
  EXPECT_EQ(splits_of(sheet(), glm::dmat4(1.0), GetParam()), sheet().split_count());
  for (const glm::dvec3 away : {glm::dvec3(20, 0, 0), glm::dvec3(-20, 0, 0), glm::dvec3(0, 20, 0),
                                glm::dvec3(0, -20, 0), glm::dvec3(0, 0, 20), glm::dvec3(0, 0, -200)})
    EXPECT_EQ(splits_of(sheet(), glm::translate(glm::dmat4(1.0), away), GetParam()), 0U);
}

TEST_P(CullingTest, SurfaceThatFacesAwayGetsNothing) {
  const glm::dmat4 turned = glm::rotate(glm::dmat4(1.0), 3.14159265358979, {0, 1, 0});
  EXPECT_EQ(splits_of(sheet(), turned, GetParam()), 0U);
  EXPECT_EQ(splits_of(sheet(), turned, GetParam(), true), sheet().split_count());  // unless its back is seen
}

TEST_P(CullingTest, MirroredSurfaceKeepsItsOutside) {
  // The outside of the sheet is +z. Mirrored in z that is -z, away from the eye; turned round first, it is +z again.
  const glm::dmat4 mirrored = glm::scale(glm::dmat4(1.0), {1, 1, -1});
  EXPECT_EQ(splits_of(sheet(), mirrored, GetParam()), 0U);
  EXPECT_EQ(splits_of(sheet(), glm::rotate(mirrored, 3.14159265358979, {0, 1, 0}), GetParam()), sheet().split_count());
}

INSTANTIATE_TEST_SUITE_P(BothQuestions, CullingTest, ::testing::Values(Culling::subtree, Culling::star),
                         [](const auto& instance) { return instance.param == Culling::star ? "star" : "subtree"; });

bool star_is_seen(const Hierarchy& hierarchy, SplitId s, const View& view) {
  const glm::dvec3 eye = view.camera().eye;
  const auto seen = [&](const Triangle& t) {
    const glm::dvec3 a(hierarchy.positions()[t.x]), b(hierarchy.positions()[t.y]), c(hierarchy.positions()[t.z]);
    return glm::dot(glm::cross(b - a, c - a), eye - a) > -1e-9;
  };
  bool any = false;
  star_of(hierarchy, s).for_each_face([&](const Triangle& t) { any = any || seen(t); });
  return any;
}

class StarCulling : public testing::Test {
 protected:
  const Hierarchy hierarchy_ = build_hierarchy(test::noisy_sphere(5, 4));
  std::array<RefineObject, 1> objects_{{{&hierarchy_, glm::dmat4(1.0), false}}};
  Refiner refiner_{objects_};
  NoOcclusion none_;
  const View view_{test::front_camera()};
};

TEST_F(StarCulling, SplitsAreTakenOnlyWhereTheirOwnFacesAreSeen) {
  RefineOptions options;
  options.budget = 2000;
  const Refinement& star = refiner_.refine(view_, options, none_);
  test::expect_valid_cut(hierarchy_, star.objects[0]);
  for (const SplitId s : test::unforced_splits(hierarchy_, star.objects[0]))
    EXPECT_TRUE(star_is_seen(hierarchy_, s, view_));
  // The paper's one question takes splits whose own faces all turn away: that is what the second question is for.
  tune(options).culling = Culling::subtree;
  const Refinement& subtree = refiner_.refine(view_, options, none_);
  test::expect_valid_cut(hierarchy_, subtree.objects[0]);
  std::size_t wasted = 0;
  for (const SplitId s : test::unforced_splits(hierarchy_, subtree.objects[0]))
    wasted += star_is_seen(hierarchy_, s, view_) ? 0U : 1U;
  EXPECT_GT(wasted, 25U);
}

TEST_F(StarCulling, UnseenSplitsAreLeftEvenWhenTheBudgetHasRoom) {
  RefineOptions options;
  options.budget = refiner_.full_triangles();
  const Refinement& result = refiner_.refine(view_, options, none_);
  EXPECT_LT(result.stats.triangles, options.budget * 3 / 4);  // the far side of a sphere is about half of it
  for (const SplitId s : test::unforced_splits(hierarchy_, result.objects[0]))
    EXPECT_TRUE(star_is_seen(hierarchy_, s, view_));
}

// A split is put off for what it would force. When others have needed all of that, only its own worth counts again. A
// node is visited by its error in pixels, which its faces raise by at most 5^(3/8) < 2.
TEST_F(StarCulling, NothingIsPutOffForWhatOthersHaveForced) {
  RefineOptions options;
  options.budget = 2000;
  const Refinement& result = refiner_.refine(view_, options, none_);
  const std::vector<bool> applied = test::applied_bits(hierarchy_, result.objects[0]);
  const ObjectView object_view(view_, glm::dmat4(1.0));
  Importance importance(objects_[0]);
  importance.begin(object_view, options);
  std::size_t free_splits = 0;
  for (SplitId s = 0; s < hierarchy_.split_count(); ++s) {
    const auto is_applied = [&](SplitId needed) { return applied[needed]; };
    if (applied[s] || !std::ranges::all_of(star_of(hierarchy_, s).dependencies(), is_applied)) continue;
    EXPECT_LE(importance.of(s).priority, 2.0 * result.stats.level_px) << s;
    ++free_splits;
  }
  EXPECT_GT(free_splits, 100U);
}

// Vertices in dents are behind the surface that they dent. Nothing else is before them, so none counts as covered.
TEST(CoveredVertices, DentsAreNotCoveredByTheirOwnSurface) {
  TriangleMesh mesh = test::grid(60, 60);
  for (glm::vec3& p : mesh.positions)
    p = {p.x - 0.5F, p.y - 0.5F, 0.004F * std::sin(40.0F * p.x) * std::cos(33.0F * p.y)};
  const Hierarchy hierarchy = build_hierarchy(mesh);
  std::array<RefineObject, 1> objects{{{&hierarchy, glm::dmat4(1.0)}}};
  Refiner refiner(objects);
  const auto software = make_software_occlusion();
  RefineOptions options;
  options.budget = 2000;
  const View view(test::front_camera(1.5));
  const std::uint64_t hash = refiner.refine(view, options, *software).hash();
  ASSERT_GT(refiner.refine(view, options, *software).stats.queries, 0U);
  tune(options).covered_factor = 1.0;
  EXPECT_EQ(refiner.refine(view, options, *software).hash(), hash);
}

TEST_F(StarCulling, WeightMovesTrianglesOffTheSilhouette) {
  const auto front_faces = [&](double exponent) {
    RefineOptions options;
    options.budget = 1500;
    tune(options).visible_exponent = exponent;
    const Refinement& result = refiner_.refine(view_, options, none_);
    return std::count_if(result.objects[0].triangles.begin(), result.objects[0].triangles.end(),
                         [&](const Triangle& t) {
                           const glm::dvec3 a(hierarchy_.positions()[t.x]), b(hierarchy_.positions()[t.y]),
                               c(hierarchy_.positions()[t.z]);
                           return glm::dot(glm::cross(b - a, c - a), view_.camera().eye - a) > 0.0;
                         });
  };
  EXPECT_GT(front_faces(1.0), front_faces(0.0));
}

}  // namespace
}  // namespace occlod
