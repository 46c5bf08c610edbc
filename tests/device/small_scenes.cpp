#include "device/small_scenes.h"

#include <gtest/gtest.h>

#include "occlod/build_hlod.h"
#include "occlod/generate.h"
#include "support/meshes.h"

namespace occlod::hlod::test {

Camera small_camera() { return {.eye = {0.0, 0.0, 3.0}, .width = 64, .height = 48, .near = 0.1, .far = 100.0}; }

const Hlod& wall() {
  static const Hlod hlod = [] {
    TriangleMesh mesh = occlod::test::grid(8, 8);
    for (glm::vec3& p : mesh.positions) p = {2.0F * p.x - 1.0F, 2.0F * p.y - 1.0F, 0.0F};
    return build_hlod(mesh);
  }();
  return hlod;
}

const Hlod& planet() {
  static const Hlod hlod = build_hlod(generate("rough-planet", {{"level", 5}}), {.node_triangles = 128});
  return hlod;
}

void draw_node(RenderDevice& device, std::uint32_t object, const Hlod& hlod, NodeId node) {
  const DrawRange all{0, 3 * hlod.node(node).triangles};
  if (all.index_count > 0) device.draw({object, node, {&all, 1}});
}

void draw_finest(RenderDevice& device, std::uint32_t object, const Hlod& hlod) {
  const Level& level = hlod.data().levels[0];
  for (std::uint32_t i = 0; i < level.node_count; ++i) draw_node(device, object, hlod, level.first_node + i);
}

std::uint32_t count_of(RenderDevice& device, const BoxRef& box) {
  const QueryId query = device.ask({&box, 1});
  const auto counts = device.wait(query);
  EXPECT_EQ(counts.size(), 1U);
  return counts.front();
}

Box cube(const glm::vec3& center, float half) { return {center - half, center + half}; }

}  // namespace occlod::hlod::test
