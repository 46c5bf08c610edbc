// What a split is worth to one eye, on stars whose faces are known.
#include "refine/importance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <limits>

#include "refine/refine_support.h"
#include "refine/tuning.h"
#include "splits/star.h"

namespace occlod {
namespace {

// A flat square in z = 0 whose outside is +z: all faces of all stars have the same normal.
const Hierarchy& square() {
  static const Hierarchy hierarchy = [] {
    TriangleMesh mesh = test::grid(8, 8);
    for (glm::vec3& p : mesh.positions) p = {p.x - 0.5F, p.y - 0.5F, 0.01F * std::sin(9.0F * p.x + 7.0F * p.y)};
    BuildOptions options;
    options.base_triangles = 2;
    return build_hierarchy(mesh, options);
  }();
  return hierarchy;
}

class ImportanceTest : public ::testing::Test {
 protected:
  Importance& seen_from(const glm::dvec3& eye) {
    Camera camera = test::front_camera();
    camera.eye = eye;
    camera.target = {0, 0, 0};
    view_ = std::make_unique<View>(camera);
    object_view_ = std::make_unique<ObjectView>(*view_, glm::dmat4(1.0));
    importance_.begin(*object_view_, options_);
    return importance_;
  }

  RefineOptions options_;
  std::unique_ptr<View> view_;
  std::unique_ptr<ObjectView> object_view_;
  Importance importance_{RefineObject{&square()}};
};

TEST_F(ImportanceTest, HeadOnAllIsSeenAndThePriorityIsTheError) {
  // The waves tilt faces by at most atan(0.01 * 11.4) = 6.5 degrees, so their cosine is above 0.98.
  for (SplitId s = 0; s < square().split_count(); ++s) {
    const Importance::Value value = seen_from({0, 0, 50}).of(s);
    EXPECT_EQ(value.visible_share, 1.0F);
    EXPECT_NEAR(value.priority, value.error.quadric_px, 0.02F * value.error.quadric_px);
  }
}

TEST_F(ImportanceTest, FromBehindNothingIsSeen) {
  for (SplitId s = 0; s < square().split_count(); ++s) EXPECT_EQ(seen_from({0, 0, -50}).of(s).visible_share, 0.0F);
}

// The eye is inside the sphere around the star, so its error has no limit, and behind all of its faces, so they are not
// seen: what changes nothing that is seen is worth nothing, not infinity times zero.
TEST_F(ImportanceTest, UnseenIsWorthNothingWhereTheErrorHasNoLimit) {
  const Importance::Value value = seen_from({0.02, 0.01, -0.05}).of(0);
  ASSERT_TRUE(std::isinf(value.error.quadric_px));
  ASSERT_EQ(value.visible_share, 0.0F);
  EXPECT_EQ(value.priority, 0.0F);
}

TEST_F(ImportanceTest, GrazingSurfaceWeighsMoreSinceItsErrorRunsAlongTheRay) {
  // Under 60 degrees the cosine is a half, so the weight is 2^exponent.
  const double angle = std::acos(0.5);
  for (const double exponent : {0.0, 0.5, 1.0, 2.0}) {
    tune(options_).grazing_exponent = exponent;
    const Importance::Value value = seen_from({0, 50 * std::sin(angle), 50 * std::cos(angle)}).of(0);
    ASSERT_EQ(value.visible_share, 1.0F);
    const double weight = std::pow(2.0, exponent);
    EXPECT_NEAR(value.priority / value.error.quadric_px, weight, 0.25 * weight * exponent + 1e-6);
  }
}

TEST_F(ImportanceTest, ForcedWeightCountsWhatIsNotSeen) {
  // Of three forced splits one is hidden: (1 + 1)^-exponent. The first of a closure is what forces, and does not count.
  const std::array<SplitId, 4> closure = {0, 1, 2, 3};
  for (const double exponent : {0.0, 0.5, 1.0}) {
    tune(options_).forced_exponent = exponent;
    Importance& importance = seen_from({0, 0, 50});
    EXPECT_EQ(importance.forced_weight(closure), 1.0F);
    importance.set_hidden(2, true);
    EXPECT_NEAR(importance.forced_weight(closure), std::pow(2.0, -exponent), 1e-6);
    importance.set_hidden(0, true);
    EXPECT_NEAR(importance.forced_weight(closure), std::pow(2.0, -exponent), 1e-6);
    importance.set_hidden(2, false);
    EXPECT_EQ(importance.forced_weight(closure), 1.0F);
  }
}

TEST_F(ImportanceTest, EyeOnACornerOfATwoSidedSurface) {
  // A ray from the eye to itself has no direction, so no cosine: the surface counts as seen head-on, and what is
  // nearest has no limit to its size on the screen.
  Importance two_sided(RefineObject{&square(), glm::dmat4(1.0), true});
  for (const SplitId s : {SplitId{0}, static_cast<SplitId>(square().split_count() - 1)}) {
    (void)seen_from(square().positions()[star_of(square(), s).vertex()]);
    ASSERT_EQ(object_view_->eye(), square().positions()[star_of(square(), s).vertex()]);
    two_sided.begin(*object_view_, options_);
    EXPECT_EQ(two_sided.of(s).priority, std::numeric_limits<float>::infinity());
  }
}

TEST_F(ImportanceTest, NothingIsRememberedFromAnotherView) {
  (void)seen_from({0, 0, 50}).visible_share(1);
  EXPECT_EQ(importance_.visible_share(1), 1.0F);
  EXPECT_EQ(seen_from({0, 0, -50}).visible_share(1), 0.0F);
  EXPECT_EQ(seen_from({0, 0, 50}).visible_share(1), 1.0F);
}

}  // namespace
}  // namespace occlod
