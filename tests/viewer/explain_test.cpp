#include "explain.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "occlod/item_buffer.h"
#include "occlod/picture.h"
#include "occlod/visibility.h"
#include "pick.h"
#include "recorded_occlusion.h"
#include "refine/tuning.h"

namespace occlod::viewer {
namespace {

// A refined planet, seen from outside.
class Explain : public ::testing::Test {
 protected:
  void refine(const Camera& camera, Visibility& visibility) {
    const RefineObject objects[] = {{object_.mesh->hierarchy.get(), object_.object_to_world, false}};
    Refiner refiner(objects);
    RefineOptions options{.budget = 1500};
    tune(options).occluder_splits = {100};
    refinement_ = refiner.refine(View(camera), options, visibility);
  }
  [[nodiscard]] const Hierarchy& hierarchy() const { return *object_.mesh->hierarchy; }

  static PlacedObject make_object() {
    PlacedObject made;
    made.mesh =
        make_view_mesh(std::make_shared<const Hierarchy>(build_hierarchy(generate("rough-planet", {{"level", 5}}))));
    return made;
  }
  PlacedObject object_ = make_object();
  Refinement refinement_;
};

// Whoever inserts a triangle has it in its star; triangles that no split inserts are those of the base mesh.
TEST_F(Explain, EveryTriangleIsInTheStarOfTheSplitThatMadeIt) {
  NoOcclusion none;
  refine(Camera{}, none);
  const RefinedObject& refined = refinement_.objects[0];
  const std::vector<SplitId> born = born_splits(hierarchy(), refined.triangles);
  ASSERT_EQ(born.size(), refined.triangles.size());
  std::size_t of_base = 0;
  for (std::size_t i = 0; i < born.size(); ++i) {
    const Triangle& t = refined.triangles[i];
    if (born[i] == no_id) {
      ++of_base;
      const auto& base = hierarchy().data().base_faces;
      EXPECT_NE(std::find(base.begin(), base.end(), t), base.end());
      continue;
    }
    EXPECT_TRUE(std::binary_search(refined.splits.begin(), refined.splits.end(), born[i]));
    const std::vector<Triangle> inserted = hierarchy().faces_of(born[i]).inserted;
    EXPECT_NE(std::find(inserted.begin(), inserted.end(), t), inserted.end()) << i;
  }
  EXPECT_LT(of_base, born.size() / 2);
}

// From frame to frame triangles keep their places: their order says nothing. Whoever made them is the same.
TEST_F(Explain, EveryTriangleIsTraceableInAnyOrder) {
  NoOcclusion none;
  const RefineObject objects[] = {{object_.mesh->hierarchy.get(), object_.object_to_world, false}};
  Refiner refiner(objects);
  Camera camera;
  for (int i = 0; i < 10; ++i) {
    refinement_ = refiner.update(View(camera), {.budget = 1500}, none);
    camera.eye.x += 0.15;
  }
  const RefinedObject& refined = refinement_.objects[0];
  const std::vector<SplitId> born = born_splits(hierarchy(), refined.triangles);
  for (std::size_t i = 0; i < born.size(); ++i) {
    if (born[i] == no_id) continue;
    const std::vector<Triangle> inserted = hierarchy().faces_of(born[i]).inserted;
    EXPECT_EQ(std::count(inserted.begin(), inserted.end(), refined.triangles[i]), 1) << i;
    EXPECT_TRUE(std::binary_search(refined.splits.begin(), refined.splits.end(), born[i])) << i;
  }
  EXPECT_FALSE(std::is_sorted(born.begin(), born.end()));  // else the test would prove nothing
}

TEST_F(Explain, ClassesAgreeWithTheItemBuffer) {
  NoOcclusion none;
  Camera camera;
  camera.eye = {0.0, 0.0, 1.6};  // so near that much of the planet is beside the picture
  refine(camera, none);
  const RefinedObject& refined = refinement_.objects[0];
  const View view(camera);
  const DrawObject drawn[] = {{hierarchy().positions(), {}, refined.triangles, glm::dmat4(1.0)}};
  ItemBuffer items;
  draw_items(items, drawn, view);
  const std::vector<Seen> seen =
      classify(object_, refined.triangles, view, visible_items(items, refined.triangles.size()), 0);
  const auto count = [&](Seen which) { return static_cast<std::size_t>(std::count(seen.begin(), seen.end(), which)); };
  EXPECT_EQ(count(Seen::visible), count_visible_items(items, refined.triangles.size()));
  EXPECT_GT(count(Seen::back_facing), 0U);
  EXPECT_GT(count(Seen::off_screen), 0U);
  // What faces the eye from the middle of the picture is no back face: the eye looks down on z = 1.
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const glm::vec3 a = hierarchy().positions()[refined.triangles[i].x];
    EXPECT_FALSE(a.z < -0.2F && seen[i] == Seen::visible) << "the far side is behind the near one";
  }
}

// Nothing else ends refinement with room in the budget and nothing hidden: what is seen is complete.
TEST_F(Explain, FullMeshIsCompleteWhereItIsSeen) {
  NoOcclusion none;
  const RefineObject objects[] = {{object_.mesh->hierarchy.get(), glm::dmat4(1.0), false}};
  Refiner refiner(objects);
  const View view{Camera{}};
  refinement_ = refiner.refine(view, {.budget = 1'000'000}, none);
  const std::vector<Outcome> found = outcomes(object_, refinement_.objects[0], view, nullptr);
  EXPECT_EQ(std::count(found.begin(), found.end(), Outcome::budget), 0);
  EXPECT_EQ(std::count(found.begin(), found.end(), Outcome::hidden), 0);
  EXPECT_GT(std::count(found.begin(), found.end(), Outcome::complete), 0);
  EXPECT_GT(std::count(found.begin(), found.end(), Outcome::back_facing), 0);
}

TEST_F(Explain, SmallBudgetEndsRefinementWhereItIsSeen) {
  NoOcclusion none;
  refine(Camera{}, none);
  const std::vector<Outcome> found = outcomes(object_, refinement_.objects[0], View(Camera{}), nullptr);
  EXPECT_GT(std::count(found.begin(), found.end(), Outcome::budget), 100);
  EXPECT_EQ(std::count(found.begin(), found.end(), Outcome::off_screen), 0);  // all of the planet is in the picture
}

// The same depth as the library's own pyramid over the same occluder, whatever the backend; only of the last.
TEST_F(Explain, RecordedOccluderIsWhatTheBackendWasGiven) {
  const auto software = make_software_occlusion();
  RecordedOcclusion recorded(*software);
  EXPECT_EQ(recorded.depth(), nullptr);
  refine(Camera{}, recorded);
  const Refinement with = refinement_;
  const auto depth = recorded.depth();
  ASSERT_NE(depth, nullptr);
  EXPECT_EQ(depth->width(), Camera{}.width);
  EXPECT_GT(depth->farthest(0, 512, 384), 0.0F);                     // the planet is in the middle
  EXPECT_EQ(depth->farthest(0, 0, 0), 0.0F);                         // and not in the corner
  EXPECT_EQ(depth->farthest(depth->level_count() - 1, 0, 0), 0.0F);  // nor everywhere
  refine(Camera{}, *software);
  EXPECT_EQ(refinement_.hash(), with.hash());  // looking on changes nothing
}

TEST_F(Explain, ErrorsAreZeroWhereNothingIsLeft) {
  NoOcclusion none;
  const RefineObject objects[] = {{object_.mesh->hierarchy.get(), glm::dmat4(1.0), true}};
  Refiner refiner(objects);
  object_.two_sided = true;
  const View view{Camera{}};
  RefineOptions options{.budget = 1'000'000};
  tune(options).culling = Culling::subtree;
  refinement_ = refiner.refine(view, options, none);
  ASSERT_EQ(refinement_.stats.triangles, hierarchy().input_triangle_count());
  for (const double error : errors_px(object_, refinement_.objects[0], view)) EXPECT_EQ(error, 0.0);
}

TEST_F(Explain, RayMeetsTheNearestTriangle) {
  NoOcclusion none;
  refine(Camera{}, none);
  RefinedFrame frame;
  frame.job.objects = std::make_shared<Objects>(Objects{object_});
  frame.sides.resize(1);
  frame.sides[0].refinement = refinement_;
  const auto hit = cast_ray(frame, {{0.1, 0.2, 3.0}, {0.0, 0.0, -1.0}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point.x, 0.1, 1e-6);
  EXPECT_GT(hit->point.z, 0.8);  // the near side of a planet of radius 0.92 to 1.08
  const Pick pick = pick_of(frame, *hit);
  EXPECT_EQ(pick.triangle, refinement_.objects[0].triangles[hit->triangle]);
  EXPECT_FALSE(cast_ray(frame, {{0.0, 0.0, 3.0}, {0.0, 0.0, 1.0}}));   // behind
  EXPECT_FALSE(cast_ray(frame, {{2.0, 0.0, 3.0}, {0.0, 0.0, -1.0}}));  // beside
}

}  // namespace
}  // namespace occlod::viewer
