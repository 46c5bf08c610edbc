#include "cell_sight.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "full_scene.h"
#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "occlod/picture.h"

namespace occlod {
namespace {

// Some chunks are outside the image and some behind others. What is left of them is the same picture.
TEST(FullScene, IsWhatAllTrianglesDraw) {
  const Hierarchy city = build_hierarchy(generate("city", {{"blocks", 3}, {"facade_cells", 8}}));
  const Hierarchy planet = build_hierarchy(generate("rough-planet", {{"level", 5}}));
  const RefineObject objects[] = {{&city},
                                  {&planet, glm::scale(glm::translate(glm::dmat4(1.0), {66, 64, 2}), {2, -1, 1})},
                                  {&planet, glm::translate(glm::dmat4(1.0), {90, 60, 1}), true}};
  const tool::FullScene scene(objects);
  std::vector<std::vector<Triangle>> triangles;
  std::vector<DrawObject> plain;
  for (const RefineObject& object : objects)
    triangles.push_back(triangles_of(*object.hierarchy, full_cut(*object.hierarchy)));
  for (std::size_t i = 0; i < 3; ++i)
    plain.push_back({objects[i].hierarchy->positions(), {}, triangles[i], objects[i].object_to_world});
  for (const glm::dvec3 target : {glm::dvec3(90, 61, 3), glm::dvec3(60, 100, 20), glm::dvec3(10, 50, -3)}) {
    Camera camera{{60, 60, 1.7}, target, {0, 0, 1}};
    camera.width = 200;
    camera.height = 150;
    camera.near = 0.1;
    camera.far = 1000.0;
    const View view(camera);
    ItemBuffer found, expected;
    scene.draw(found, view);
    draw_items(expected, plain, view);
    EXPECT_EQ(found.depth.nearness, expected.depth.nearness);
    for (std::size_t pixel = 0; pixel < found.items.size(); ++pixel) {
      ASSERT_EQ(found.items[pixel] == no_item, expected.items[pixel] == no_item);
      if (found.items[pixel] != no_item) {
        ASSERT_LT(scene.item(found.items[pixel]).object, 3U);
      }
    }
  }
}

// Without a triangle that is drawn, nearly every pixel misses one.
TEST(CellSight, FindsWhatIsLeftOut) {
  const Hierarchy city = build_hierarchy(generate("city", {{"blocks", 2}, {"facade_cells", 4}}));
  const RefineObject objects[] = {{&city}};
  const tool::FullScene scene(objects);
  const CellOptions options{.eyes = tool::cube_eyes(64, 0.1)};
  const CellBox cell{{58, 58, 1}, {62, 62, 2.5}};
  CellBuilder builder(objects, nullptr, options);
  std::vector<CellObjectCut> cut = builder.build(cell).objects;
  const tool::CellEyes eyes{4, 32, 3};
  EXPECT_EQ(tool::look_from(cell, scene, objects, options, cut, eyes).missing, 0U);
  cut[0].triangles.clear();
  const tool::CellSight nothing = tool::look_from(cell, scene, objects, options, cut, eyes);
  EXPECT_GT(nothing.missing, 9 * nothing.pixels / 10);  // the rest is near faces that turn away from the cell
  EXPECT_EQ(tool::count_seen(cell, objects, 0.1, cut, eyes), 0U);
}

// The same pixels as look_from() counts, by triangle; from the street nothing below the ground is seen.
TEST(CellSight, CountsPixelsByTriangle) {
  const Hierarchy city = build_hierarchy(generate("city", {{"blocks", 2}, {"facade_cells", 4}}));
  const RefineObject objects[] = {{&city}, {&city, glm::translate(glm::dmat4(1.0), {0, 0, -200})}};
  const tool::FullScene scene(objects);
  const CellOptions options{.eyes = tool::cube_eyes(64, 0.1)};
  const CellBox cell{{58, 58, 1}, {62, 62, 2.5}};
  const tool::CellEyes eyes{4, 32, 3};
  CellBuilder builder(objects, nullptr, options);
  const tool::CellSight sight = tool::look_from(cell, scene, objects, options, builder.build(cell).objects, eyes);
  std::size_t above = 0, below = 0;
  const std::vector<std::uint32_t> pixels = tool::count_pixels(cell, scene, objects, 0.1, eyes);
  ASSERT_EQ(pixels.size(), scene.triangle_count());
  for (std::uint32_t i = 0; i < pixels.size(); ++i) (scene.item(i).object == 0 ? above : below) += pixels[i];
  EXPECT_EQ(above + below, sight.pixels);
  EXPECT_GT(above, 9 * sight.pixels / 10);
}

}  // namespace
}  // namespace occlod
