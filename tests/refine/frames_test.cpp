// Refinement from frame to frame.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "occlod/base.h"
#include "occlod/item_buffer.h"
#include "occlod/refiner.h"
#include "occlod/visibility.h"
#include "oracle/cut_error.h"
#include "refine/refine_support.h"
#include "refine/tuning.h"
#include "splits/hierarchy_data.h"
#include "splits/star.h"

namespace occlod {
namespace {

const Hierarchy& planet() {
  static const Hierarchy h = build_hierarchy(test::noisy_sphere(5, 3));
  return h;
}

Camera orbiting(double degrees, double distance = 3.0) {
  Camera camera = test::front_camera();
  const double angle = degrees * std::numbers::pi / 180.0;
  camera.eye = {distance * std::sin(angle), 0.4, distance * std::cos(angle)};
  return camera;
}

std::vector<Triangle> sorted(std::vector<Triangle> triangles) {
  std::sort(triangles.begin(), triangles.end(),
            [](const Triangle& a, const Triangle& b) { return std::tuple(a.x, a.y, a.z) < std::tuple(b.x, b.y, b.z); });
  return triangles;
}

// As test::expect_valid_cut, in any order of triangles.
void expect_valid(const Hierarchy& hierarchy, const RefinedObject& object) {
  ASSERT_TRUE(std::is_sorted(object.splits.begin(), object.splits.end()));
  test::expect_closed(hierarchy, object);
  EXPECT_TRUE(sorted(object.triangles) == sorted(test::active_triangles(hierarchy, object.splits)));
}

struct Way {
  Culling culling;
  bool occlusion;
};

class Frames : public testing::TestWithParam<Way> {
 protected:
  std::unique_ptr<Visibility> backend_ =
      GetParam().occlusion ? make_software_occlusion() : std::unique_ptr<Visibility>(new NoOcclusion);
  RefineOptions options(std::size_t budget) const {
    RefineOptions options;
    options.budget = budget;
    tune(options).culling = GetParam().culling;
    return options;
  }
};

// Of the triangles that own a pixel.
double visible_share(const std::vector<RefineObject>& objects, const Refinement& refinement, const Camera& camera) {
  ItemBuffer picture;
  picture.reset(camera.width, camera.height);
  std::uint32_t items = 0;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const std::vector<Triangle>& triangles = refinement.objects[i].triangles;
    draw_items(picture, objects[i].hierarchy->positions(), triangles,
               glm::mat4(View(camera).world_to_clip() * objects[i].object_to_world), items);
    items += static_cast<std::uint32_t>(triangles.size());
  }
  return static_cast<double>(count_visible_items(picture, items)) / items;
}

// Two statues that hide each other in turn.
std::vector<RefineObject> two_planets() {
  return {{&planet(), glm::dmat4(1.0), false},
          {&planet(), glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, 0.3, 2.5)), false}};
}

// An orbit, a jump to the other side, a look away and back, and as much with parallel rays: whatever happens, a frame
// is a mesh within the budget, and what it tells about its changes makes the buffer of the frame before that of this
// frame.
TEST_P(Frames, EveryFrameIsAValidMeshWithinTheBudget) {
  const std::vector<RefineObject> objects = two_planets();
  Refiner refiner(objects);
  std::vector<Camera> cameras;
  for (int i = 0; i < 20; ++i) cameras.push_back(orbiting(3.0 * i, 6.0));
  cameras.push_back(orbiting(240.0, 6.0));
  for (int i = 0; i < 10; ++i) cameras.push_back(orbiting(240.0 + i, 6.0 - 0.3 * i));
  Camera away = orbiting(250.0, 6.0);
  away.target = 2.0 * away.eye;
  cameras.push_back(away);
  cameras.push_back(orbiting(251.0, 6.0));
  for (int i = 0; i < 10; ++i) cameras.push_back(orthographic(orbiting(251.0 + 2.0 * i, 6.0 - 0.3 * i)));
  cameras.push_back(orbiting(272.0, 3.0));
  std::vector<std::vector<Triangle>> buffers(objects.size());
  std::size_t budget = 3000;
  for (std::size_t frame = 0; frame < cameras.size(); ++frame) {
    SCOPED_TRACE(frame);
    if (frame == 8) budget = 1200;  // less from one frame to the next
    if (frame == 12) budget = 5000;
    const Refinement& refinement = refiner.update(View(cameras[frame]), options(budget), *backend_);
    std::size_t triangles = 0, changed = 0;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const RefinedObject& object = refinement.objects[i];
      expect_valid(planet(), object);
      triangles += object.triangles.size();
      buffers[i].resize(object.triangles.size());
      for (const TriangleRange& range : object.changes) {
        std::copy_n(object.triangles.begin() + range.first, range.count, buffers[i].begin() + range.first);
        changed += range.count;
      }
      EXPECT_TRUE(buffers[i] == object.triangles);
    }
    EXPECT_LE(triangles, budget);
    EXPECT_EQ(refinement.stats.triangles, triangles);
    EXPECT_EQ(refinement.stats.changed_triangles, changed);
  }
}

// The queues take and give by the same priorities as refinement from scratch, so that errors are the same but for the
// hysteresis, for what the order of equally important splits decides, and for what both have applied that nobody sees
// or that yields because its vertex is covered. The largest error is that of a single split.
TEST_P(Frames, ErrorsAreNearlyThoseFromScratch) {
  const std::vector<RefineObject> objects = two_planets();
  Refiner frames(objects), scratch(objects);
  double sum = 0.0;
  constexpr int count = 30;
  for (int i = 0; i < count; ++i) {
    const Camera camera = orbiting(i < 20 ? 2.0 * i : 180.0 + i, 5.0);
    const View view(i % 16 < 8 ? camera : orthographic(camera));
    const Refinement& kept = frames.update(view, options(3000), *backend_);
    const Refinement& fresh = scratch.refine(view, options(3000), *backend_);
    const double kept_px = oracle::cut_error(objects, kept, view, *backend_).quadric_px;
    const double fresh_px = oracle::cut_error(objects, fresh, view, *backend_).quadric_px;
    EXPECT_LE(kept_px, 1.5 * fresh_px) << i;
    sum += kept_px / fresh_px;
  }
  EXPECT_LE(sum / count, 1.1);
}

// Along a path as many of the triangles are visible as from scratch: what nobody sees any more goes, also where what is
// seen needs some of it.
TEST_P(Frames, AsMuchIsVisibleAsFromScratch) {
  const std::vector<RefineObject> objects = two_planets();
  Refiner frames(objects), scratch(objects);
  double kept = 0.0, fresh = 0.0;
  constexpr int count = 40;
  for (int i = 0; i < count; ++i) {
    const Camera camera = orbiting(3.0 * i, 5.0);
    const View view(camera);
    kept += visible_share(objects, frames.update(view, options(3000), *backend_), camera);
    fresh += visible_share(objects, scratch.refine(view, options(3000), *backend_), camera);
  }
  EXPECT_GE(kept / count, fresh / count - 0.035);
}

// What the budget is not needed for is not kept either.
TEST_P(Frames, LeavesThatNobodySeesGoThoughThereIsRoom) {
  const std::vector<RefineObject> objects = {{&planet(), glm::dmat4(1.0), false}};
  Refiner frames(objects), scratch(objects);
  const std::size_t enough = 2 * frames.full_triangles();
  for (int i = 0; i <= 30; ++i) {
    Camera camera = orbiting(0.0);
    const double angle = 2.0 * i * std::numbers::pi / 180.0;  // the eye turns away
    camera.target = camera.eye + glm::dvec3(std::sin(angle), 0.0, -std::cos(angle));
    const View view(camera);
    const std::size_t kept = frames.update(view, options(enough), *backend_).stats.triangles;
    const std::size_t fresh = scratch.refine(view, options(enough), *backend_).stats.triangles;
    EXPECT_LE(static_cast<double>(kept), 1.1 * static_cast<double>(fresh)) << i;
  }
}

// Nothing changes for an eye that stands still, once a frame has found nothing to do.
TEST_P(Frames, AStillCameraComesToRest) {
  const std::vector<RefineObject> objects = two_planets();
  Refiner refiner(objects);
  const View view(orbiting(10.0));
  static_cast<void>(refiner.update(View(orbiting(5.0)), options(3000), *backend_));
  std::uint64_t hash = 0;
  int frames = 0;
  for (bool at_rest = false; !at_rest && frames < 50; ++frames) {
    const Refinement& refinement = refiner.update(view, options(3000), *backend_);
    at_rest = frames > 0 && refinement.stats.visits == 0 && refinement.stats.queries == 0;
    hash = refinement.hash();
  }
  const Refinement& again = refiner.update(view, options(3000), *backend_);
  EXPECT_EQ(again.hash(), hash);
  EXPECT_EQ(again.stats.changed_triangles, 0U);
  EXPECT_EQ(again.stats.visits, 0U);
  EXPECT_LT(frames, 50);
}

TEST_P(Frames, TheSameCallsGiveTheSameBytes) {
  const std::vector<RefineObject> objects = two_planets();
  Refiner a(objects), b(objects);
  for (int i = 0; i < 12; ++i) {
    const View view(orbiting(2.5 * i));
    const std::uint64_t hash = a.update(view, options(2000), *backend_).hash();
    EXPECT_EQ(b.update(view, options(2000), *backend_).hash(), hash) << i;
  }
}

// A limit of 40 changes a frame: a jump is caught up with in steps, and the end is as if there had been no limit.
TEST_P(Frames, WorkIsLimitedAndFollows) {
  const std::vector<RefineObject> objects = two_planets();
  Refiner refiner(objects);
  RefineOptions limited = options(3000);
  static_cast<void>(refiner.update(View(orbiting(0.0, 6.0)), limited, *backend_));
  limited.max_changes = 40;
  const View view(orbiting(100.0, 6.0));
  int frames = 0;
  bool pending = true;
  for (; pending && frames < 500; ++frames) {
    const Refinement& refinement = refiner.update(view, limited, *backend_);
    for (std::size_t i = 0; i < objects.size(); ++i) expect_valid(planet(), refinement.objects[i]);
    // One step may make room by a few merges and force a few splits.
    EXPECT_LE(refinement.stats.new_splits + refinement.stats.merged_splits, 40U + 64U);
    pending = refinement.stats.pending;
  }
  EXPECT_GT(frames, 5);
  EXPECT_LT(frames, 500);
  limited.max_changes = 0;
  const Refinement& caught_up = refiner.update(view, limited, *backend_);
  Refiner scratch(objects);
  const double fresh = oracle::cut_error(objects, scratch.refine(view, limited, *backend_), view, *backend_).quadric_px;
  EXPECT_LE(oracle::cut_error(objects, caught_up, view, *backend_).quadric_px, 1.25 * fresh);
}

// What was hidden from where the eye rested may be seen from where it goes.
TEST(FramesOcclusion, AnEyeThatLeavesItsRestAsksAgain) {
  const std::vector<RefineObject> objects = two_planets();
  Refiner refiner(objects);
  const auto software = make_software_occlusion();
  RefineOptions options;
  options.budget = 3000;
  bool at_rest = false;
  for (int frame = 0; !at_rest && frame < 50; ++frame)
    at_rest = refiner.update(View(orbiting(10.0)), options, *software).stats.occluder_draws == 0;
  ASSERT_TRUE(at_rest);
  const RefineStats moved = refiner.update(View(orbiting(11.0)), options, *software).stats;
  EXPECT_GT(moved.occluder_draws, 0U);
  EXPECT_GT(moved.queries, 0U);
}

// Another weighing is another order of splits: the frame is that of a Refiner that has seen nothing before.
TEST(FramesOptions, AnotherWeighingStartsFromTheBaseMeshes) {
  const std::vector<RefineObject> objects = two_planets();
  Refiner kept(objects), fresh(objects);
  NoOcclusion none;
  RefineOptions options;
  options.budget = 3000;
  for (int i = 0; i < 5; ++i) static_cast<void>(kept.update(View(orbiting(3.0 * i)), options, none));
  tune(options).visible_exponent = 0.0;
  const View view(orbiting(15.0));
  const std::uint64_t hash = kept.update(view, options, none).hash();
  EXPECT_EQ(hash, fresh.update(view, options, none).hash());
}

// What is asked about occlusion may change from frame to frame, as the setting `auto` does: the mesh goes on, and
// what is switched off is not asked about any more.
TEST(FramesOptions, OtherQuestionsGoOn) {
  const std::vector<RefineObject> objects = two_planets();
  Refiner refiner(objects);
  const auto software = make_software_occlusion();
  RefineOptions options;
  options.budget = 3'000;
  (void)refiner.update(View(orbiting(0.0, 6.0)), options, *software);
  const auto goes_on = [&](double degrees) {
    const Refinement& next = refiner.update(View(orbiting(degrees, 6.0)), options, *software);
    for (const RefinedObject& object : next.objects) expect_valid(planet(), object);
    return next.stats.new_splits < next.stats.splits / 2;
  };
  tune(options).ask_stars = false;
  EXPECT_TRUE(goes_on(1.0));
  tune(options).level_step = 1;
  EXPECT_TRUE(goes_on(2.0));
  tune(options).final_check = false;
  EXPECT_TRUE(goes_on(3.0));
  options.effects = {{}, {.occlusion = false}};
  EXPECT_TRUE(goes_on(5.0));
  EXPECT_EQ(refiner.update(View(orbiting(6.0, 6.0)), options, *software).effects[1].queries(), 0U);
  EXPECT_GT(refiner.update(View(orbiting(7.0, 6.0)), options, *software).effects[0].queries(), 0U);
}

// Most of what is hidden lies near the level, and what the check would show of it the next frame shows anyway. So the
// check asks about a part of the nodes that the questions before it found hidden.
TEST(FramesCheck, AsksOnlyAboutLargeErrors) {
  const std::vector<RefineObject> objects = two_planets();
  RefineOptions checked;
  checked.budget = 3'000;
  RefineOptions unchecked = checked;
  tune(unchecked).final_check = false;
  const auto software = make_software_occlusion(), other = make_software_occlusion();
  Refiner with(objects), without(objects);
  for (Refiner* const refiner : {&with, &without})  // both have the same cut when the frame begins
    (void)refiner->update(View(orbiting(0.0, 6.0)), unchecked, refiner == &with ? *software : *other);
  const RefineStats fewer = without.update(View(orbiting(3.0, 6.0)), unchecked, *other).stats;
  const RefineStats more = with.update(View(orbiting(3.0, 6.0)), checked, *software).stats;
  ASSERT_EQ(fewer.occluder_draws, 1U);
  ASSERT_EQ(more.occluder_draws, 2U);
  EXPECT_GT(more.queries, fewer.queries);
  EXPECT_LT(more.queries - fewer.queries, 3 * fewer.queries_hidden / 4);
}

INSTANTIATE_TEST_SUITE_P(Ways, Frames,
                         testing::Values(Way{Culling::subtree, false}, Way{Culling::subtree, true},
                                         Way{Culling::star, false}, Way{Culling::star, true}),
                         [](const auto& way) {
                           return std::string(way.param.culling == Culling::star ? "star" : "subtree") +
                                  (way.param.occlusion ? "_software" : "_none");
                         });

// What is refined to a tolerance is merged again where the tolerance allows, as the eye moves away.
TEST(FramesTolerance, DetailGoesAsTheEyeGoes) {
  const std::vector<RefineObject> objects = {{&planet(), glm::dmat4(1.0), false}};
  Refiner refiner(objects), scratch(objects);
  NoOcclusion none;
  RefineOptions options;
  options.budget = refiner.full_triangles();
  options.tolerance_px = 2.0;
  const std::size_t near = refiner.update(View(orbiting(0.0, 2.0)), options, none).stats.triangles;
  Refinement far;
  for (int i = 1; i <= 20; ++i) far = refiner.update(View(orbiting(0.0, 2.0 + 0.5 * i)), options, none);
  const View last(orbiting(0.0, 12.0));
  const std::size_t fresh = scratch.refine(last, options, none).stats.triangles;
  EXPECT_LT(far.stats.triangles, near / 2);
  EXPECT_LE(far.stats.triangles, fresh + fresh / 5);
  EXPECT_LE(far.stats.max_error_px, 2.0);
}

// Refinement from scratch weighs splits again as their needs are applied, so that the budget ends at about the level of
// later frames, and these have little left to do.
TEST(FramesSettling, LaterFramesFindLittleToDo) {
  const std::vector<RefineObject> objects = {{&planet(), glm::dmat4(1.0), false}};
  Refiner refiner(objects);
  NoOcclusion none;
  RefineOptions options;
  options.budget = 1000;
  const RefineStats first = refiner.update(View(orbiting(0.0)), options, none).stats;
  for (int i = 1; i <= 12; ++i) {
    const RefineStats& stats = refiner.update(View(orbiting(0.5 * i)), options, none).stats;
    EXPECT_NEAR(stats.level_px, first.level_px, 0.12 * first.level_px) << i;
    EXPECT_LE(stats.visits, first.visits / 5) << i;
  }
}

// A coarser tolerance frees what the budget had been spent on: what remains is about what refinement from scratch
// makes.
TEST(FramesTolerance, ACoarserOneMergesAtOnce) {
  const std::vector<RefineObject> objects = two_planets();
  Refiner refiner(objects), scratch(objects);
  NoOcclusion none;
  RefineOptions options;
  options.budget = 3000;
  const View view(orbiting(0.0, 3.0));
  EXPECT_EQ(refiner.update(view, options, none).stats.triangles, 3000U);
  options.tolerance_px = 12.0;
  const RefineStats fresh = scratch.refine(view, options, none).stats;
  const RefineStats kept = refiner.update(view, options, none).stats;
  ASSERT_LT(fresh.triangles, 2500U);
  EXPECT_LE(kept.triangles, fresh.triangles + fresh.triangles / 5);
  EXPECT_LE(kept.max_error_px, options.tolerance_px);
}

// A vertex that appears starts beside its parent and arrives after as many calls as asked for.
TEST(FramesGeomorph, VerticesSlideFromTheirParents) {
  const std::vector<RefineObject> objects = {{&planet(), glm::dmat4(1.0), false}};
  Refiner refiner(objects);
  NoOcclusion none;
  RefineOptions options;
  options.budget = 2000;
  options.geomorph_frames = 4;
  EXPECT_TRUE(refiner.update(View(orbiting(0.0)), options, none).objects[0].geomorphs.empty());
  const Refinement first = refiner.update(View(orbiting(3.0)), options, none);
  ASSERT_FALSE(first.objects[0].geomorphs.empty());
  const Geomorph moving = first.objects[0].geomorphs[0];
  EXPECT_EQ(moving.parent,
            star_of(planet(), moving.vertex - static_cast<VertexId>(planet().base_vertex_count())).parent_vertex());
  float last = 0.0F;
  int calls = 0;
  for (Refinement now = first; !now.objects[0].geomorphs.empty() && calls < 20; ++calls) {
    for (const Geomorph& g : now.objects[0].geomorphs)
      if (g.vertex == moving.vertex) {
        EXPECT_GT(g.t, last);
        EXPECT_LT(g.t, 1.0F);
        last = g.t;
      }
    now = refiner.update(View(orbiting(3.0)), options, none);
  }
  EXPECT_FLOAT_EQ(last, 0.8F);  // 1/5, 2/5, 3/5, 4/5
  EXPECT_LT(calls, 20);
}

// A child starts where its parent is drawn, not where that will be: 0 -> 1 at half is 0.5, and 0.5 -> 2 at half 1.25.
TEST(FramesGeomorph, ChildrenFollowParentsThatSlide) {
  const glm::vec3 own[] = {{0.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F}};
  MorphedPositions positions(own);
  const Geomorph both[] = {{1, 0, 0.5F}, {2, 1, 0.5F}};
  positions.update(both);
  EXPECT_FLOAT_EQ(positions.positions()[1].x, 0.5F);
  EXPECT_FLOAT_EQ(positions.positions()[2].x, 1.25F);
  const Geomorph last[] = {{2, 1, 0.75F}};  // the parent has arrived at 1: 1 -> 2 at three quarters
  positions.update(last);
  EXPECT_FLOAT_EQ(positions.positions()[1].x, 1.0F);
  EXPECT_FLOAT_EQ(positions.positions()[2].x, 1.75F);
  EXPECT_EQ(std::vector<VertexId>(positions.moved().begin(), positions.moved().end()), (std::vector<VertexId>{1, 2}));
  positions.update({});
  EXPECT_FLOAT_EQ(positions.positions()[2].x, 2.0F);
  EXPECT_EQ(std::vector<VertexId>(positions.moved().begin(), positions.moved().end()), std::vector<VertexId>{2});
}

// Refinement lists a parent that slides before its children, which MorphedPositions relies on.
TEST(FramesGeomorph, ParentsComeBeforeTheirChildren) {
  const std::vector<RefineObject> objects = {{&planet(), glm::dmat4(1.0), false}};
  Refiner refiner(objects);
  NoOcclusion none;
  RefineOptions options;
  options.budget = 1500;
  options.geomorph_frames = 6;
  std::size_t pairs = 0;
  for (int i = 0; i < 12; ++i) {
    options.budget += 150;
    const std::vector<Geomorph>& list = refiner.update(View(orbiting(4.0 * i)), options, none).objects[0].geomorphs;
    for (std::size_t child = 0; child < list.size(); ++child)
      for (std::size_t k = 0; k < list.size(); ++k) {
        if (list[k].vertex != list[child].parent) continue;
        EXPECT_LT(k, child);
        ++pairs;
      }
  }
  EXPECT_GT(pairs, 0U);
}

// Reading split by split does not find two splits that remove the same face.
TEST(Frames, AFaceThatIsRemovedTwiceIsAnErrorEachTime) {
  HierarchyData data = copy_data(planet());
  for (SplitId s = 50;; ++s) {  // whose star names one face twice
    const SplitStar star = star_of(planet(), s);
    if (!star.is_fan() || star.removed_count() < 2) continue;
    std::uint32_t& bytes = data.stars[data.nodes[s].star + 1 + star.ring().size() + star.dependencies().size()];
    bytes = (bytes & ~0xFFU) | ((bytes >> 8U) & 0xFFU);
    break;
  }
  const Hierarchy damaged = make_hierarchy(std::move(data));
  const RefineObject object{&damaged};
  Refiner refiner({&object, 1});
  NoOcclusion all;
  RefineOptions coarse, fine;
  coarse.budget = refiner.base_triangles() + 20;
  fine.budget = refiner.full_triangles();
  const View view(orbiting(0.0));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(refiner.update(view, coarse, all).objects[0].triangles.size(),
              refiner.refine(view, coarse, all).objects[0].triangles.size());
    EXPECT_THROW((void)refiner.update(view, fine, all), Error);
    EXPECT_THROW((void)refiner.refine(view, fine, all), Error);
  }
}

}  // namespace
}  // namespace occlod
