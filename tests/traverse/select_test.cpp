// What a renderer without a device is told to draw: the picture of `vfc` to the bit, within the tolerance or the
// budget.
#include "occlod/select.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <set>
#include <string>
#include <vector>

#include "hlod/draw/front_sizes.h"
#include "hlod/memory_source.h"
#include "occlod/base.h"
#include "occlod/device.h"
#include "occlod/item_buffer.h"
#include "occlod/node_store.h"
#include "occlod/picture.h"
#include "occlod/traverser.h"
#include "traverse/front_checks.h"
#include "traverse/small_scenes.h"

namespace occlod::hlod {
namespace {

using namespace test;

// What a renderer sees that draws the selected triangles and knows nothing else.
std::vector<float> picture(const Selection& selection, std::span<const PlacedHlod> objects, const View& view) {
  std::vector<std::vector<Triangle>> triangles;
  std::vector<DrawObject> drawn;
  for (const SelectedNode& node : selection.nodes) {
    std::vector<Triangle>& of_node = triangles.emplace_back();
    for (const DrawRange& range : node.ranges)
      for (std::uint32_t i = range.first_index; i < range.first_index + range.index_count; i += 3)
        of_node.emplace_back(node.mesh.indices[i], node.mesh.indices[i + 1], node.mesh.indices[i + 2]);
    drawn.push_back({node.mesh.positions, {}, {}, objects[node.object].object_to_world});
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    drawn[i].triangles = triangles[i];
    count += triangles[i].size();
  }
  EXPECT_EQ(count, selection.triangles);
  ItemBuffer items;
  draw_items(items, drawn, view);
  return items.depth.nearness;
}

const Frame& in_the_frustum(Traverser& traverser, const View& view, SoftwareDevice& device, double tolerance_px) {
  return traverser.draw_frame(view, device, {.strategy = Strategy::vfc, .tolerance_px = tolerance_px});
}

// Two copies, one of them mirrored, turned and stretched.
std::vector<PlacedHlod> two_copies(const Hlod& hlod) {
  glm::dmat4 place = glm::translate(glm::dmat4(1.0), glm::dvec3(hlod.data().box.max - hlod.data().box.min));
  place = glm::scale(glm::rotate(place, 0.7, glm::dvec3(0.0, 0.0, 1.0)), glm::dvec3(1.0, -0.8, 1.3));
  return {{&hlod}, {&hlod, place}};
}

TEST(Selector, ShowsAllThatIsInTheFrustum) {
  for (const Hlod* hlod : {&city(Grouping::shifted), &planet(Grouping::shifted), &city(Grouping::nested)}) {
    const std::vector<PlacedHlod> objects = two_copies(*hlod);
    for (const double tolerance_px : {2.0, 0.0}) {
      Selector selector(objects);
      Traverser truth(objects);
      SoftwareDevice device;
      std::size_t selected = 0, all = 0;
      for (int i = 0; i < 20; ++i) {
        const View view(walk(hlod->data().box, i, 60));
        const Selection& selection = selector.select(view, {.tolerance_px = tolerance_px});
        all += in_the_frustum(truth, view, device, tolerance_px).stats.drawn_triangles;
        ASSERT_EQ(picture(selection, objects, view), device.depth().nearness) << i;
        EXPECT_LE(selection.largest_error_px, tolerance_px);
        EXPECT_EQ(selection.tolerance_px, tolerance_px);
        EXPECT_EQ(selection.missing, 0U);
        selected += selection.triangles;
      }
      EXPECT_LT(selected, all) << "something hides something";
    }
  }
}

TEST(Selector, WithoutOcclusionIsTheFrontItself) {
  const Hlod& hlod = city(Grouping::shifted);
  const PlacedHlod objects[] = {{&hlod}};
  Selector selector(objects);
  Traverser truth(objects);
  SoftwareDevice device;
  for (int i = 0; i < 5; ++i) {
    const View view(walk(hlod.data().box, i, 60));
    const Selection& selection = selector.select(view, {.tolerance_px = 1.0, .occlusion = false});
    const Frame& frame = in_the_frustum(truth, view, device, 1.0);
    ASSERT_EQ(selection.nodes.size(), frame.draws.size());
    for (std::size_t k = 0; k < frame.draws.size(); ++k) {
      const DrawnNode& drawn = frame.draws[k];
      EXPECT_EQ(selection.nodes[k].node, drawn.node);
      EXPECT_TRUE(std::ranges::equal(selection.nodes[k].ranges,
                                     std::span(frame.ranges).subspan(drawn.first_range, drawn.range_count)));
    }
    EXPECT_EQ(selection.hidden, 0U);
    EXPECT_EQ(selection.front_hash, frame.front_hash);
  }
}

// The input itself, drawn from an eye that has moved since it was selected, in a view that was wider by as much. The
// eye moves sideways by what covers a pixel at the distance of the nearest point of the box, or less.
TEST(Selector, SlackHoldsForAnEyeThatHasMoved) {
  constexpr int slack_px = 8;
  const Hlod& hlod = planet(Grouping::shifted);
  const PlacedHlod objects[] = {{&hlod}};
  const Box& box = hlod.data().box;
  const glm::dvec3 middle = glm::dvec3(box.min + box.max) / 2.0, half = glm::dvec3(box.max - box.min) / 2.0;
  std::size_t selected = 0;
  const auto lacks_something = [&](double slack) {
    selected = 0;
    Selector selector(objects);
    SoftwareDevice device;
    Traverser truth(objects);
    int lacking = 0;
    for (int i = 0; i < 20; ++i) {
      Camera camera;
      camera.eye = middle + 3.0 * half.x * glm::dvec3(std::cos(0.3 * i), std::sin(0.3 * i), 0.3);
      camera.target = middle;
      camera.up = {0.0, 0.0, 1.0};
      camera.width = camera.height = 120;
      camera.fov_y_deg = 40.0;
      camera.near = 0.01 * half.x;
      camera.far = 100.0 * half.x;
      Camera wide = camera;
      wide.width = wide.height = camera.height + 2 * slack_px;
      wide.fov_y_deg = glm::degrees(2.0 * std::atan(std::tan(glm::radians(20.0)) * wide.height / camera.height));
      const Selection& selection = selector.select(View(wide), {.tolerance_px = 0.0, .slack_px = slack});
      selected += selection.nodes.size();
      const double focal_px = View(camera).focal_length_px();
      EXPECT_NEAR(View(wide).focal_length_px(), focal_px, 1e-6 * focal_px);
      const double nearest = glm::length(camera.eye - middle) - glm::length(half);
      const glm::dvec3 aside = glm::normalize(glm::cross(middle - camera.eye, camera.up));
      const glm::dvec3 move = (i % 2 == 0 ? 1.0 : -1.0) * (slack_px - 1) * nearest / focal_px * aside;
      camera.eye += move;
      camera.target += move;
      in_the_frustum(truth, View(camera), device, 0.0);
      if (picture(selection, objects, View(camera)) != device.depth().nearness) ++lacking;
    }
    return lacking;
  };
  EXPECT_EQ(lacks_something(slack_px), 0);
  const std::size_t with_slack = selected;
  static_cast<void>(lacks_something(0.0));
  EXPECT_GT(with_slack, selected);
}

TEST(Selector, MovedObjectsAreSelectedWhereTheyAre) {
  const Hlod& hlod = planet(Grouping::shifted);
  std::vector<PlacedHlod> objects = {{&hlod}};
  Selector selector(objects);
  const View view(walk(hlod.data().box, 0, 60));
  const std::vector<float> before = picture(selector.select(view), objects, view);
  objects[0].object_to_world = glm::translate(glm::dmat4(1.0), glm::dvec3(0.3, 0.2, 0.1));
  selector.set_transform(0, objects[0].object_to_world);
  Traverser truth(objects);
  SoftwareDevice device;
  in_the_frustum(truth, view, device, 1.0);
  EXPECT_EQ(picture(selector.select(view), objects, view), device.depth().nearness);
  EXPECT_NE(before, device.depth().nearness);
}

// What is forecast for any tolerance is what a front without occlusion has, to the triangle.
TEST(FrontSizes, AreThoseOfFronts) {
  for (const Hlod* hlod : {&city(Grouping::shifted), &planet(Grouping::shifted), &city(Grouping::nested)}) {
    const std::vector<PlacedHlod> objects = two_copies(*hlod);
    Traverser traverser(objects);
    SoftwareDevice device;
    FrontSizes sizes;
    for (int i = 0; i < 10; ++i) {
      const View view(walk(hlod->data().box, i, 60));
      for (const double least_px : {0.0, 1.0}) {
        sizes.assign(view, objects, least_px);
        for (double px = least_px; px < 1e4; px = 1.7 * px + 0.01)
          EXPECT_EQ(sizes.at(px),
                    static_cast<double>(in_the_frustum(traverser, view, device, px).stats.drawn_triangles))
              << px;
        const double all = sizes.at(least_px);
        for (const double wanted : {all, all / 2.0, all / 5.0}) {
          const double px = sizes.tolerance_px(wanted);
          EXPECT_TRUE(sizes.at(px) <= wanted || px == sizes.coarsest_px());
        }
        EXPECT_EQ(sizes.tolerance_px(all), least_px);
        EXPECT_GT(sizes.tolerance_px(all, 7.0), 7.0);
      }
    }
  }
}

// Never more than the budget, most of it used, and the coarsest picture where it is too small for that.
TEST(Selector, KeepsTheBudget) {
  const Hlod& hlod = city(Grouping::shifted);
  const PlacedHlod objects[] = {{&hlod}};
  const Camera camera = walk(hlod.data().box, 7, 60);
  const std::size_t whole = Selector(objects).select(View(camera), {.tolerance_px = 0.0}).triangles;
  for (const bool occlusion : {true, false}) {
    Selector selector(objects);
    std::size_t most = 0;
    for (int i = 0; i < 60; ++i) {
      const Selection& selection = selector.select(View(walk(hlod.data().box, i, 60)),
                                                   {.tolerance_px = 0.0, .budget = whole / 2, .occlusion = occlusion});
      ASSERT_LE(selection.triangles, whole / 2);
      EXPECT_LE(selection.largest_error_px, selection.tolerance_px);
      most = std::max(most, selection.triangles);
    }
    EXPECT_GT(most, whole / 3);
  }
  Selector selector(objects);
  std::size_t roots = 0;
  for (const NodeId n : hlod.data().roots) roots += hlod.node(n).triangles;
  const Selection& coarsest = selector.select(View(camera), {.budget = 1, .occlusion = false});
  EXPECT_EQ(coarsest.triangles, roots);
  EXPECT_GT(coarsest.largest_error_px, 1.0);
}

// With room for everything the budget decides nothing; once it has, the tolerance comes back.
TEST(Selector, ABudgetThatIsLargeEnoughDecidesNothing) {
  const Hlod& hlod = planet(Grouping::shifted);
  const PlacedHlod objects[] = {{&hlod}};
  Selector selector(objects);
  const View view(walk(hlod.data().box, 0, 60));
  const std::size_t wanted = Selector(objects).select(view, {.tolerance_px = 1.0}).triangles;
  EXPECT_GT(selector.select(view, {.budget = wanted / 4}).tolerance_px, 1.0);
  for (int i = 0; i < 100; ++i) selector.select(view, {.budget = 2 * wanted});
  const Selection& selection = selector.select(view, {.budget = 2 * wanted});
  EXPECT_EQ(selection.tolerance_px, 1.0);
  EXPECT_EQ(selection.triangles, wanted);
}

// Nothing comes and goes where nothing moves, whatever the budget.
TEST(Selector, ABudgetSettles) {
  const Hlod& hlod = city(Grouping::shifted);
  const PlacedHlod objects[] = {{&hlod}};
  const View view(walk(hlod.data().box, 7, 60));
  const std::size_t whole = Selector(objects).select(view, {.tolerance_px = 0.0}).triangles;
  for (const std::size_t budget : {whole / 8, whole / 4, whole / 3, whole / 2}) {
    Selector selector(objects);
    const SelectOptions options{.tolerance_px = 0.0, .budget = budget};
    for (int i = 0; i < 100; ++i) selector.select(view, options);
    const double tolerance_px = selector.select(view, options).tolerance_px;
    for (int i = 0; i < 50; ++i) EXPECT_EQ(selector.select(view, options).tolerance_px, tolerance_px);
  }
}

// Coarser nodes while meshes are missing, which are named; then what the whole HLOD shows.
TEST(Selector, PagedMeshesComeWhileCoarserOnesAreSelected) {
  const Hlod& whole = city(Grouping::shifted);
  TrialCacheOptions cache;
  cache.load = TrialLoad::simulated;
  cache.simulated_mb_per_s = 0.2;
  const Hlod hlod = paged(whole, cache);
  const PlacedHlod objects[] = {{&hlod}}, truth[] = {{&whole}};
  const View view(walk(whole.data().box, 3, 60));
  const std::vector<float> wanted = picture(Selector(truth).select(view), truth, view);
  Selector selector(objects);
  std::set<NodeId> missing;
  for (int i = 0; i < 2000; ++i) {
    const Selection& selection = selector.select(view);
    for (const SelectedNode& node : selection.nodes) ASSERT_TRUE(hlod.is_resident(node.node));
    const std::vector<NodeId> now = hlod.store()->missing();
    EXPECT_EQ(now.size(), selection.missing);
    for (const NodeId n : now) EXPECT_FALSE(hlod.is_resident(n));
    missing.insert(now.begin(), now.end());
    if (now.empty() && selection.largest_error_px <= 1.0) {
      EXPECT_EQ(picture(selection, objects, view), wanted);
      EXPECT_GT(i, 10);
      EXPECT_FALSE(missing.empty());
      for (const NodeId n : missing) EXPECT_TRUE(hlod.is_resident(n));
      return;
    }
  }
  FAIL() << "something never came";
}

// Its parents stay, with or without occlusion.
TEST(Selector, ADamagedNodeIsNotSelected) {
  const Hlod& whole = planet(Grouping::shifted);
  for (const bool occlusion : {true, false}) {
    const auto faults = std::make_shared<ReadFaults>();
    const NodeId first = whole.data().levels[0].first_node;
    for (NodeId n = first; n < first + whole.data().levels[0].node_count; n += 4) faults->damaged.insert(n);
    TrialCacheOptions cache;
    cache.load = TrialLoad::blocking;
    const Hlod hlod = paged(whole, cache, faults);
    const PlacedHlod objects[] = {{&hlod}};
    Selector selector(objects);
    std::mt19937_64 random(47);
    const View view(from_afar(whole, random));
    std::size_t told = 0;
    for (int i = 0; i < 3; ++i) {
      for (const SelectedNode& node : selector.select(view, {.tolerance_px = 0.0, .occlusion = occlusion}).nodes)
        EXPECT_FALSE(faults->damaged.contains(node.node));
      told += hlod.store()->take_failures().size();
    }
    EXPECT_GT(told, 0U) << "some are in sight";
  }
}

TEST(Selector, MistakesAreTold) {
  const Hlod& hlod = planet(Grouping::shifted);
  const PlacedHlod objects[] = {{&hlod}};
  Selector selector(objects);
  try {
    selector.select(View(Camera{}), {.tolerance_px = -1.0});
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.diagnosis().subject, "selection options");
    EXPECT_EQ(error.diagnosis().place, "option tolerance_px");
  }
  EXPECT_THROW(Selector({}), Error);
  EXPECT_THROW(selector.set_transform(1, glm::dmat4(1.0)), Error);
}

}  // namespace
}  // namespace occlod::hlod
