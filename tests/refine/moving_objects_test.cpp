// Objects that are placed elsewhere between two calls.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "occlod/base.h"
#include "occlod/visibility.h"
#include "refine/refine_support.h"
#include "refine/tuning.h"

namespace occlod::test {
namespace {

struct Case {
  Culling culling;
  bool occlusion;
};

std::string name_of(const testing::TestParamInfo<Case>& info) {
  return std::string(info.param.culling == Culling::star ? "Star" : "Subtree") +
         (info.param.occlusion ? "Software" : "None");
}

constexpr double quarter = 1.5707963267948966;
const glm::dvec3 up(0, 1, 0);

// Two spheres before a camera that stands still: a large one, and a small one that moves.
class MovingObjects : public testing::TestWithParam<Case> {
 protected:
  MovingObjects() {
    options_.budget = 3'000;
    tune(options_).culling = GetParam().culling;
  }

  Visibility& visibility() { return GetParam().occlusion ? *software_ : static_cast<Visibility&>(none_); }
  void place(std::size_t object, const glm::dmat4& at) {
    objects_[object].object_to_world = at;
    refiner_.set_transform(object, at);
  }
  const Refinement& update(Refiner& refiner) { return refiner.update(view_, options_, visibility()); }
  // Until nothing happens any more.
  const Refinement& settled(Refiner& refiner) {
    const Refinement* result = &update(refiner);
    for (int i = 0; i < 200 && result->stats.visits + result->stats.queries > 0; ++i) result = &update(refiner);
    return *result;
  }
  void expect_valid(const Refinement& refinement) const {
    EXPECT_LE(refinement.stats.triangles, options_.budget);
    for (const RefinedObject& object : refinement.objects) {
      expect_closed(hierarchy_, object);
      std::vector<Triangle> triangles = object.triangles, active = active_triangles(hierarchy_, object.splits);
      const auto less = [](const Triangle& a, const Triangle& b) {
        return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
      };
      std::sort(triangles.begin(), triangles.end(), less);
      std::sort(active.begin(), active.end(), less);
      EXPECT_EQ(triangles, active);
    }
  }

  static glm::dmat4 small_at(double x, double y, double z) {
    return glm::scale(glm::translate(glm::dmat4(1.0), {x, y, z}), glm::dvec3(0.4));
  }
  static glm::dmat4 turned(double angle) { return glm::rotate(glm::dmat4(1.0), angle, up); }

  Hierarchy hierarchy_ = build_hierarchy(noisy_sphere(5, 3));
  std::vector<RefineObject> objects_ = {{.hierarchy = &hierarchy_},
                                        {.hierarchy = &hierarchy_, .object_to_world = small_at(1.5, 0.0, 0.5)}};
  Refiner refiner_{objects_};
  std::unique_ptr<Visibility> software_ = make_software_occlusion();
  NoOcclusion none_;
  RefineOptions options_;
  View view_{front_camera(3.0)};
};

TEST_P(MovingObjects, FromScratchAreRefinedAsIfMadeThere) {
  for (const glm::dmat4& at : {small_at(0.0, 0.2, 1.8), small_at(-2.0, 0.0, 0.0), turned(2.0) * small_at(1.0, 1.0, 1.0),
                               glm::scale(glm::dmat4(1.0), {1.0, 0.5, -2.0})}) {
    (void)refiner_.refine(view_, options_, visibility());
    place(1, at);
    const std::uint64_t hash = refiner_.refine(view_, options_, visibility()).hash();
    Refiner fresh(objects_);
    EXPECT_EQ(hash, fresh.refine(view_, options_, visibility()).hash());
  }
}

// Turned, moved, stretched and mirrored, little by little and at once: in each frame the mesh is valid, and when all
// stands still again its errors are those of a refiner that has seen nothing else.
TEST_P(MovingObjects, FrameToFrameTheMeshFollows) {
  const auto expect_as_fresh = [&] {
    const RefineStats followed = settled(refiner_).stats;
    expect_valid(update(refiner_));
    Refiner fresh(objects_);
    const RefineStats expected = settled(fresh).stats;
    EXPECT_LT(followed.max_quadric_error_px, 1.25 * expected.max_quadric_error_px);
    EXPECT_GT(followed.max_quadric_error_px, 0.6 * expected.max_quadric_error_px);
  };
  (void)settled(refiner_);
  for (int i = 1; i <= 20; ++i) {
    place(0, turned(0.1 * i));
    place(1, turned(-0.1 * i) * small_at(1.5, 0.0, 0.5));
    expect_valid(update(refiner_));
  }
  expect_as_fresh();
  for (int i = 1; i <= 10; ++i) {
    place(1, small_at(1.5 - 0.15 * i, 0.1 * i, 0.5 + 0.1 * i));
    expect_valid(update(refiner_));
  }
  expect_as_fresh();
  place(1, glm::scale(glm::dmat4(1.0), {0.3, 0.6, -0.4}) * small_at(4.0, 0.0, 0.0));
  expect_as_fresh();
  place(0, turned(2.0 * quarter));
  expect_as_fresh();
}

// What turned away from the camera shows itself now, and the other side does not; some splits matter to both.
TEST_P(MovingObjects, AnObjectThatTurnsShowsItsOtherSide) {
  const std::vector<SplitId> before = settled(refiner_).objects[0].splits;
  place(0, turned(2.0 * quarter));
  const std::vector<SplitId> after = settled(refiner_).objects[0].splits;
  std::vector<SplitId> kept;
  std::set_intersection(before.begin(), before.end(), after.begin(), after.end(), std::back_inserter(kept));
  EXPECT_LT(kept.size(), before.size() * 3 / 4);
}

TEST_P(MovingObjects, AStillCameraIsNotAtRest) {
  (void)settled(refiner_);
  EXPECT_EQ(update(refiner_).stats.visits + update(refiner_).stats.queries, 0U);
  place(1, objects_[1].object_to_world);  // where it is
  EXPECT_EQ(update(refiner_).stats.visits + update(refiner_).stats.queries, 0U);
  place(1, small_at(0.0, 0.3, 1.5));
  const RefineStats moved = update(refiner_).stats;
  EXPECT_GT(moved.visits, 0U);
  EXPECT_GT(moved.new_splits, 0U);
  EXPECT_EQ(moved.occluder_draws > 0, GetParam().occlusion);
}

// The budget is less than either of them could use: what the one that has left had is the other's.
TEST_P(MovingObjects, OneThatLeavesThePictureFreesItsTriangles) {
  const std::size_t before = settled(refiner_).objects[0].triangles.size();
  ASSERT_GT(refiner_.update(view_, options_, visibility()).objects[1].triangles.size(), 300U);
  place(1, small_at(0.0, 0.0, 10.0));  // behind the camera
  const Refinement& after = settled(refiner_);
  EXPECT_EQ(after.objects[1].triangles.size(), hierarchy_.base_triangle_count());
  EXPECT_GT(after.objects[0].triangles.size(), before);
  const Refinement& fresh = refiner_.refine(view_, options_, visibility());
  EXPECT_EQ(fresh.objects[1].triangles.size(), hierarchy_.base_triangle_count());
}

// The small one stands still behind the large one, which steps aside and comes back.
TEST_P(MovingObjects, WhatHidesOthersNoLongerDoesWhenItHasGone) {
  if (!GetParam().occlusion) GTEST_SKIP() << "nothing is hidden";
  place(1, small_at(0.0, 0.0, -2.0));
  const std::size_t hidden = settled(refiner_).objects[1].triangles.size();
  place(0, glm::translate(glm::dmat4(1.0), {-2.5, 0.0, 0.0}));
  const std::size_t seen = settled(refiner_).objects[1].triangles.size();
  place(0, glm::dmat4(1.0));
  const std::size_t hidden_again = settled(refiner_).objects[1].triangles.size();
  EXPECT_GT(seen, hidden + 200);
  EXPECT_LT(hidden_again, hidden + 50);
}

TEST_P(MovingObjects, PlacesThatAreNoneAreRefused) {
  const std::uint64_t hash = refiner_.refine(view_, options_, visibility()).hash();
  glm::dmat4 with_nan(1.0), projective(1.0), flat(1.0);
  with_nan[3][0] = std::numeric_limits<double>::quiet_NaN();
  projective[0][3] = 0.1;
  flat[1][1] = 0.0;
  for (const glm::dmat4& bad : {with_nan, projective, flat}) EXPECT_THROW(refiner_.set_transform(1, bad), Error);
  EXPECT_THROW(refiner_.set_transform(2, glm::dmat4(1.0)), Error);
  EXPECT_EQ(refiner_.refine(view_, options_, visibility()).hash(), hash);
}

INSTANTIATE_TEST_SUITE_P(Ways, MovingObjects,
                         testing::Values(Case{Culling::star, false}, Case{Culling::star, true},
                                         Case{Culling::subtree, false}, Case{Culling::subtree, true}),
                         name_of);

}  // namespace
}  // namespace occlod::test
