// What the software device promises beyond other devices: exact pictures, morphs, counts of work, the same bits.
#include <gtest/gtest.h>

#include <algorithm>

#include "device/small_scenes.h"
#include "hlod/draw/box_proxy.h"
#include "occlod/build_hlod.h"
#include "occlod/device.h"
#include "occlod/generate.h"
#include "raster/every_target.h"

namespace occlod::hlod {
namespace {

using namespace test;

std::vector<Triangle> triangles_of(const NodeMesh& mesh, const DrawRange& range) {
  std::vector<Triangle> triangles;
  for (std::uint32_t i = range.first_index; i < range.first_index + range.index_count; i += 3)
    triangles.emplace_back(mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]);
  return triangles;
}

void begin(SoftwareDevice& device, const Hlod& hlod, Camera camera = small_camera()) {
  const PlacedHlod placed{&hlod, glm::dmat4(1.0)};
  device.begin_frame(View(camera), {&placed, 1});
}

// The same depths as draw_depth() has for the same triangles, also where the device pads its rows.
TEST(SoftwareDevice, DrawsWhatTheRasteriserDraws) {
  for (const int width : {64, 1024}) {
    Camera camera = small_camera();
    camera.width = width;
    const View view(camera);
    SoftwareDevice device;
    begin(device, planet(), camera);
    DepthBuffer expected;
    expected.reset(width, camera.height);
    const ObjectView object(view, glm::dmat4(1.0));
    for (const NodeId n : {NodeId{1}, NodeId{3}}) {
      const NodeMesh mesh = planet().mesh(n);
      const DrawRange range{3, static_cast<std::uint32_t>(mesh.indices.size()) - 6};
      device.draw({0, n, {&range, 1}});
      draw_depth(expected, mesh.positions, triangles_of(mesh, range), object.object_to_clip());
    }
    EXPECT_EQ(device.depth().nearness, expected.nearness) << width;
    EXPECT_GT(*std::max_element(expected.nearness.begin(), expected.nearness.end()), 0.0F);
  }
}

// A node with a parent, and a patch of it whose vertices move.
struct MovingPatch {
  NodeId node = 0;
  Patch patch;
};
MovingPatch moving_patch() {
  for (NodeId n = 0; n < planet().node_count(); ++n)
    for (const Patch& patch : planet().patches(n)) {
      if (patch.parent == no_id) continue;
      const NodeMesh mesh = planet().mesh(n);
      for (const std::uint16_t v : mesh.indices.subspan(patch.first_index, patch.index_count))
        if (mesh.merged_into[v] != stays) return {n, patch};
    }
  ADD_FAILURE() << "the planet has no such patch";
  return {};
}

// Where a patch's vertices have gone all the way, it is drawn from the parent's positions, bit for bit; half-way, from
// their middles.
TEST(SoftwareDevice, MorphsTowardsTheParent) {
  const auto [node, patch] = moving_patch();
  const NodeMesh mesh = planet().mesh(node), parent = planet().mesh(patch.parent);
  for (const float morph : {0.0F, 0.5F, 1.0F}) {
    std::vector<glm::vec3> positions(mesh.positions.begin(), mesh.positions.end());
    for (std::size_t v = 0; v < positions.size(); ++v)
      if (mesh.merged_into[v] != stays) {
        const glm::vec3& target =
            parent.positions[std::min<std::size_t>(mesh.merged_into[v], parent.positions.size() - 1)];
        positions[v] = morph == 1.0F ? target : morph == 0.0F ? positions[v] : positions[v] * 0.5F + target * 0.5F;
      }
    const DrawRange range{patch.first_index, patch.index_count, morph};
    SoftwareDevice device;
    begin(device, planet());
    device.draw({0, node, {&range, 1}});
    DepthBuffer expected;
    expected.reset(64, 48);
    draw_depth(expected, positions, triangles_of(mesh, range),
               ObjectView(View(small_camera()), glm::dmat4(1.0)).object_to_clip());
    EXPECT_EQ(device.depth().nearness, expected.nearness) << morph;
  }
}

// Ranges of one node, each with its own morph, and one over several patches, are what each patch is by itself.
TEST(SoftwareDevice, MorphsPatchByPatch) {
  NodeId node = 0;
  while (node < planet().node_count() && planet().patches(node).size() < 2) ++node;
  ASSERT_LT(node, planet().node_count());
  const std::span<const Patch> patches = planet().patches(node);
  const auto depth_of = [&](const std::vector<std::vector<DrawRange>>& draws) {
    SoftwareDevice device;
    begin(device, planet());
    for (const auto& ranges : draws) device.draw({0, node, ranges});
    return device.depth().nearness;
  };
  std::vector<DrawRange> different;
  std::vector<std::vector<DrawRange>> one_by_one, alike_one_by_one;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const float morph = 0.25F + 0.5F * static_cast<float>(i % 2);
    different.push_back({patches[i].first_index, patches[i].index_count, morph});
    one_by_one.push_back({different.back()});
    alike_one_by_one.push_back({{patches[i].first_index, patches[i].index_count, 0.75F}});
  }
  EXPECT_EQ(depth_of({different}), depth_of(one_by_one));
  EXPECT_EQ(depth_of({{{0, 3 * planet().node(node).triangles, 0.75F}}}), depth_of(alike_one_by_one));
}

// A node refined within: the triangles of the cut, by positions of the mesh and of its splits, with none or all of
// them.
TEST(SoftwareDevice, DrawsCuts) {
  HlodBuildOptions options;
  options.node_triangles = 128;
  options.within = Within::splits;
  const Hlod hlod = build_hlod(generate("rough-planet", {{"level", 5}}), options);
  NodeId node = 0;
  while (node < hlod.node_count() && !(hlod.has_within(node) && hlod.data().within[node].splits > 8)) ++node;
  ASSERT_LT(node, hlod.node_count());
  const NodeMesh mesh = hlod.mesh(node);
  std::vector<glm::vec3> positions(mesh.positions.begin(), mesh.positions.end());
  positions.insert(positions.end(), hlod.within(node).positions.begin(), hlod.within(node).positions.end());
  std::vector<std::uint64_t> fragments;
  for (const std::uint32_t splits : {0U, 5U, hlod.data().within[node].splits}) {
    const NodeCut cut = cut_with_splits(hlod, node, splits);
    SoftwareDevice device;
    begin(device, hlod);
    device.draw({0, node, {}, cut.indices, splits});
    std::vector<Triangle> triangles;
    for (std::size_t i = 0; i < cut.indices.size(); i += 3)
      triangles.emplace_back(cut.indices[i], cut.indices[i + 1], cut.indices[i + 2]);
    DepthBuffer expected;
    expected.reset(64, 48);
    draw_depth(expected, positions, triangles, ObjectView(View(small_camera()), glm::dmat4(1.0)).object_to_clip());
    EXPECT_EQ(device.depth().nearness, expected.nearness) << splits;
    EXPECT_EQ(device.work().triangles, triangles.size());
    fragments.push_back(device.work().fragments);
  }
  EXPECT_GT(fragments.back(), 0U);
}

TEST(SoftwareDevice, CountsItsWork) {
  SoftwareDevice device;
  begin(device, wall());
  EXPECT_EQ(device.work().draws, 0U);
  draw_finest(device, 0, wall());
  const std::uint64_t fragments = device.work().fragments;
  EXPECT_EQ(device.work().draws, 1U);
  EXPECT_EQ(device.work().triangles, 128U);
  // Neighbours share no pixel and leave none out: what is not empty, once.
  const std::vector<float> depth = device.depth().nearness;
  EXPECT_EQ(fragments,
            static_cast<std::uint64_t>(std::count_if(depth.begin(), depth.end(), [](float z) { return z > 0; })));
  draw_finest(device, 0, wall());
  EXPECT_EQ(device.work().fragments, 2 * fragments);  // the hidden ones too
  const Box hidden = cube({0.0F, 0.0F, -0.5F}, 0.2F);
  EXPECT_EQ(count_of(device, {0, hidden}), 0U);
  const Screen screen{View(small_camera())};
  const ObjectView object(View(small_camera()), glm::dmat4(1.0));
  raster::BoxOutline outline;
  EXPECT_EQ(
      device.work().query_fragments,
      covered_pixels(screen, project_box(screen, proxy_space(screen, View(small_camera()), object), hidden), outline));
  (void)count_of(device, {0, cube({0.0F, 0.0F, 3.0F}, 0.2F)});
  EXPECT_EQ(device.work().boxes, 2U);
  EXPECT_EQ(device.work().drawn_boxes, 1U);
  device.end_frame();
  EXPECT_EQ(device.work().boxes, 2U);
  begin(device, wall());
  EXPECT_EQ(device.work().boxes, 0U);
}

// On an empty screen the pixels that pass are those that the proxy covers, whatever it is.
TEST(SoftwareDevice, CountsAllThatABoxCoversOnAnEmptyScreen) {
  SoftwareDevice device;
  begin(device, planet());
  const View view(small_camera());
  const Screen screen(view);
  const ProxySpace space = proxy_space(screen, view, ObjectView(view, glm::dmat4(1.0)));
  raster::BoxOutline outline;
  for (NodeId n = 0; n < planet().node_count(); ++n)
    EXPECT_EQ(count_of(device, {0, planet().node(n).box}),
              covered_pixels(screen, project_box(screen, space, planet().node(n).box), outline))
        << n;
}

TEST(SoftwareDevice, KeepsWhichTriangleOwnsEachPixel) {
  SoftwareDevice device(true), plain;
  begin(device, planet());
  begin(plain, planet());
  draw_finest(device, 0, planet());
  draw_finest(plain, 0, planet());
  EXPECT_EQ(device.items().depth.nearness, plain.depth().nearness);
  EXPECT_EQ(device.depth().nearness, plain.depth().nearness);
  EXPECT_EQ(device.work().fragments, plain.work().fragments);
  // The first triangle that is drawn at a pixel of a second drawing of the same keeps it.
  const std::vector<std::uint32_t> items = device.items().items;
  const auto drawn = static_cast<std::uint32_t>(device.work().triangles);
  EXPECT_TRUE(std::all_of(items.begin(), items.end(), [&](std::uint32_t i) { return i == no_item || i < drawn; }));
  draw_node(device, 0, planet(), planet().data().levels[0].first_node);
  EXPECT_EQ(device.items().items, items);
}

// Depths and counts, with every instruction set.
TEST(SoftwareDevice, HasTheSameBitsEverywhere) {
  struct Result {
    std::vector<float> depth;
    std::vector<std::uint32_t> counts;
    std::uint64_t fragments;
    bool operator==(const Result&) const = default;
  };
  std::vector<BoxRef> boxes;
  for (NodeId n = 0; n < planet().node_count(); ++n) boxes.push_back({0, planet().node(n).box});
  std::vector<Result> results;
  occlod::test::for_every_target([&](const char*) {
    SoftwareDevice device;
    begin(device, planet());
    draw_finest(device, 0, planet());
    const auto counts = device.wait(device.ask_each(boxes));
    results.push_back({device.depth().nearness, {counts.begin(), counts.end()}, device.work().fragments});
  });
  for (const Result& result : results) EXPECT_TRUE(result == results.front());
}

}  // namespace
}  // namespace occlod::hlod
