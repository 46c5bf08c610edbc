#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>
#include <random>
#include <vector>

#include "refine/front_evaluation.h"
#include "refine/refine_support.h"
#include "refine/weigh.h"

namespace occlod {
namespace {

// A front whose nodes are near and far, in front of the eye and behind it, around it, with cones of all widths and with
// none.
class RandomFront {
 public:
  RandomFront(std::size_t count, unsigned seed)
      : hierarchy(build_hierarchy(test::noisy_sphere(5, 3))), front(hierarchy, true) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> at(-6.0F, 6.0F), part(0.0F, 1.0F);
    for (SplitId s = 0; s < count; ++s) {
      FrontNode& node = front.node(front.obtain(s));
      node.sphere = {{at(random), at(random), at(random)}, std::pow(10.0F, -4.0F + 5.0F * part(random))};
      node.cone = {glm::normalize(glm::vec3(at(random), at(random), at(random)) + glm::vec3(1e-3F)),
                   part(random) < 0.2F ? -1.0F : part(random)};
      all.push_back(s);
    }
  }

  Hierarchy hierarchy;
  Front front;
  std::vector<Front::Index> all;
};

// What the functions for one node tell.
float expected_scale(const FrontNode& node, const ObjectView& view, bool tests_cones) {
  if (!view.may_be_inside(node.sphere)) return 0.0F;
  if (tests_cones && faces_away(node.cone, node.sphere, view.eye())) return 0.0F;
  return view.largest_scale_px(node.sphere);
}

// Vectors do the same operations in the same order as the functions for one node, on every instruction set, so that a
// frame gives the same mesh on every machine; 2001 nodes leave a rest that fills no vector.
TEST(WeighNodes, ManyAtOnceAreAsOneByOne) {
  RandomFront nodes(2001, 3);
  for (const View& view : {View(test::front_camera()), View(orthographic(test::front_camera()))})
    for (const glm::dmat4& placed :
         {glm::dmat4(1.0), glm::scale(glm::dmat4(1.0), glm::dvec3(-1.0, 2.0, 0.5)),
          glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(0.5, 0.0, 1.0)), 0.7, glm::dvec3(0.6, 0.0, 0.8))})
      for (const bool tests_cones : {false, true}) {
        const ObjectView seen(view, placed);
        weigh_nodes(nodes.front, nodes.all, {seen, tests_cones, {}, {}});
        std::size_t outside = 0, facing_away = 0;
        for (const Front::Index k : nodes.all) {
          const FrontNode& node = nodes.front.node(k);
          ASSERT_EQ(nodes.front.scales().value[k], expected_scale(node, seen, tests_cones));
          const bool out = !seen.may_be_inside(node.sphere);
          const bool away = !out && tests_cones && faces_away(node.cone, node.sphere, seen.eye());
          ASSERT_EQ(nodes.front.is(k, Front::outside), out);
          ASSERT_EQ(nodes.front.is(k, Front::facing_away), away);
          outside += out ? 1 : 0;
          facing_away += away ? 1 : 0;
        }
        EXPECT_GT(outside, 100U);
        EXPECT_EQ(facing_away > 0U, tests_cones);
      }
}

// How a camera goes on from frame to frame.
struct Way {
  const char* name;
  Camera (*at)(double t);
};

Camera orbiting(double t) {
  Camera camera = test::front_camera();
  camera.eye = {5.0 * std::sin(t), 0.4, 5.0 * std::cos(t)};
  camera.target = {0.0, 0.0, 0.0};
  return camera;
}
Camera walking(double t) {
  Camera camera = test::front_camera();
  camera.eye = {2.0 * t, 0.3 * std::sin(9.0 * t), 3.0 - 4.0 * t};
  camera.target = camera.eye + glm::dvec3(0.4, -0.2, -1.0);
  return camera;
}
Camera turning(double t) {
  Camera camera = test::front_camera();
  camera.eye = {0.5, 0.2, 4.0};
  camera.target = camera.eye + glm::dvec3(std::sin(4.0 * t), 0.3 * std::sin(7.0 * t), -std::cos(4.0 * t));
  camera.up = {0.2 * std::sin(5.0 * t), 1.0, 0.0};
  return camera;
}
constexpr Way ways[] = {{"orbiting", orbiting}, {"walking", walking}, {"turning", turning}};

// Calls each(view, outdated nodes) for every frame of a way after weighing all nodes for the first; those that must be
// found anew are found after the call.
template <typename Each>
void follow(const Way& way, RandomFront& nodes, const glm::dmat4& placed, const Each& each) {
  const glm::vec3 middle(0.2F, -0.1F, 0.3F);
  constexpr int frames = 200;
  ViewMotion motion;
  View last(way.at(0.0));
  ObjectView last_seen(last, placed);
  nodes.front.scales().forget_all();
  weigh_nodes(nodes.front, nodes.all, {last_seen, true, motion, middle});
  for (int frame = 1; frame < frames; ++frame) {
    const View view(way.at(static_cast<double>(frame) / frames));
    const ObjectView seen(view, placed);
    const std::optional<ViewMotion> gone = motion_between({last, last_seen}, {view, seen}, middle);
    ASSERT_TRUE(gone);
    motion = {motion.eye_distance + gone->eye_distance, motion.center_distance + gone->center_distance,
              motion.rotation_rad + gone->rotation_rad};
    nodes.front.scales().update(motion);
    each(seen);
    std::vector<Front::Index> outdated;
    for (const Front::Index k : nodes.all)
      if (nodes.front.scales().is_outdated(k)) outdated.push_back(k);
    weigh_nodes(nodes.front, outdated, {seen, true, motion, middle});
    last = view;
    last_seen = seen;
  }
}

// What is said to hold does: the verdict of every node that need not be weighed anew is that of weighing it, and its
// scale is off by no more than is admitted. A quarter of the nodes at most is weighed in a frame, or all this were for
// nothing; and some of what holds has changed, or all this were true of a still camera only.
TEST(WeighNodes, WhatHoldsIsWhatWeighingTells) {
  for (const Way& way : ways)
    for (const glm::dmat4& placed :
         {glm::dmat4(1.0), glm::scale(glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(0.5, 0.0, 1.0)), 0.7,
                                                  glm::dvec3(0.6, 0.0, 0.8)),
                                      glm::dvec3(-2.0))}) {
      SCOPED_TRACE(way.name);
      RandomFront nodes(2001, 5);
      const BoundedValues& scales = nodes.front.scales();
      std::size_t held = 0, changed = 0, outdated = 0;
      follow(way, nodes, placed, [&](const ObjectView& seen) {
        for (const Front::Index k : nodes.all) {
          if (scales.is_outdated(k)) {
            ++outdated;
            continue;
          }
          ++held;
          const FrontNode& node = nodes.front.node(k);
          const float now = expected_scale(node, seen, true), then = scales.value[k];
          changed += now != then ? 1 : 0;
          ASSERT_EQ(nodes.front.is(k, Front::outside), !seen.may_be_inside(node.sphere));
          ASSERT_EQ(now > 0.0F, then > 0.0F);
          ASSERT_LE(now, then * scales.error_factor[k] * (1.0F + 1e-6F));
          ASSERT_GE(now * scales.error_factor[k] * (1.0F + 1e-6F), then);
        }
      });
      EXPECT_LT(outdated, held / 3);
      EXPECT_GT(changed, held / 50);
    }
}

// The same for priorities by stars: of all splits of a sphere, seen from an eye that circles it and comes near.
TEST(FrontView, WhatHoldsIsWhatLookingTells) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(4, 3));
  const RefineObject object{&hierarchy, glm::dmat4(1.0), false};
  RefineOptions options;
  Importance importance(object);
  Front front(hierarchy, true);
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) front.obtain(s);
  ViewMotion motion;
  std::optional<View> last;
  std::optional<ObjectView> last_seen;
  std::size_t held = 0, outdated = 0;
  for (int frame = 0; frame < 150; ++frame) {
    Camera camera = test::front_camera();
    const double angle = 0.02 * frame, distance = 4.0 - 0.015 * frame;
    camera.eye = {distance * std::sin(angle), 0.3, distance * std::cos(angle)};
    const View view(camera);
    const ObjectView seen(view, glm::dmat4(1.0));
    if (last) {
      const std::optional<ViewMotion> gone = motion_between({*last, *last_seen}, {view, seen}, {});
      ASSERT_TRUE(gone);
      motion = {motion.eye_distance + gone->eye_distance, motion.center_distance + gone->center_distance,
                motion.rotation_rad + gone->rotation_rad};
    }
    last = view;
    last_seen = seen;
    importance.begin(*last_seen, options);
    BoundedValues& priorities = front.priorities();
    priorities.update(motion);
    for (Front::Index k = 0; k < front.size(); ++k) {
      const FrontStar& star = front.star(k);
      if (star.has_too_many || !is_wholly_inside(star.sphere, seen)) {
        ASSERT_TRUE(priorities.is_outdated(k) || priorities.value[k] == 0.0F);
        continue;
      }
      const FrontPriority found =
          *front_priority(star, {front.errors()[k], front.guaranteed_errors()[k]},
                          {seen, importance, false, 0.5F, static_cast<float>(2.0 * tan_corner_angle(seen)), {}});
      const float now = found.value.visible_share > 0.0F ? found.value.priority : 0.0F;
      if (priorities.is_outdated(k)) {
        ++outdated;
        priorities.put(k, now, found.growth, motion);
        continue;
      }
      ++held;
      ASSERT_LE(now, priorities.value[k] * priorities.error_factor[k] * (1.0F + 1e-5F));
      ASSERT_GE(now * priorities.error_factor[k] * (1.0F + 1e-5F), priorities.value[k]);
    }
  }
  EXPECT_LT(outdated, held / 2);
}

// Sums of motion begin again at 0 when they have grown too large. What was forgotten then stays unknown until it is
// computed anew, however much smaller the new sums are.
TEST(BoundedValues, StayForgottenWhenSumsBeginAgain) {
  BoundedValues values;
  for (int k = 0; k < 9; ++k) values.add();
  const ViewMotion far = {100.0, 100.0, 20.0}, again = {0.1, 0.1, 0.01};
  for (std::size_t k = 0; k < 9; ++k) values.put(k, 2.0F, {k % 2 == 0 ? 3.0F : -3.0F, 0.5F, 1.0F, 0.5F, 1.0F}, far);
  values.update(far);
  for (std::size_t k = 0; k < 9; ++k) EXPECT_FALSE(values.is_outdated(k)) << k;
  values.forget_all();
  values.update(again);
  for (std::size_t k = 0; k < 9; ++k) EXPECT_TRUE(values.is_outdated(k)) << k;
  values.put(4, 2.0F, {3.0F, 0.5F, 1.0F, 0.5F, 1.0F}, far);
  values.forget(4);
  values.update(again);
  EXPECT_TRUE(values.is_outdated(4));
}

}  // namespace
}  // namespace occlod
