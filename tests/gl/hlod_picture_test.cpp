// What the device `gl` draws, against the item buffer of the same triangles.
#include <array>
#include <glm/ext/matrix_transform.hpp>

#include "gl/hlod_cases.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "support/meshes.h"

namespace occlod::gl {
namespace {

class HlodPicture : public EachHlodDevice {
 protected:
  void SetUp() override {
    EachHlodDevice::SetUp();
    view_ = sphere_view();
  }
  void begin(HlodDevice& device, const hlod::Hlod& hlod, const glm::dmat4& object_to_world = glm::dmat4(1.0)) const {
    const std::array<hlod::PlacedHlod, 1> objects{{{&hlod, object_to_world, false}}};
    device.begin_frame(view_, objects);
  }
  [[nodiscard]] DepthBuffer depth_of_level(HlodDevice& device, std::uint32_t level, float morph = 0.0F) const {
    begin(device, sphere_hlod());
    draw_level(device, sphere_hlod(), level, morph);
    static_cast<void>(device.end_frame());
    return device.read_depth();
  }
};
INSTANTIATE_TEST_SUITE_P(Gl, HlodPicture, testing::ValuesIn(tested_devices()), device_label);

TEST_P(HlodPicture, LevelsLookLikeTheirTriangles) {
  const auto device = make();
  for (const std::uint32_t level : {0U, 1U, 2U}) {
    SCOPED_TRACE(level);
    const ItemBuffer expected = items_of(level_mesh(sphere_hlod(), level), view_);
    EXPECT_EQ(different_pixels(view_, expected.depth, depth_of_level(*device, level)), 0U);
    EXPECT_GT(count_visible_items(expected, 100'000), 100U);
  }
}

// A test of the test: another level is another picture.
TEST_P(HlodPicture, LevelsDiffer) {
  const auto device = make();
  const ItemBuffer coarse = items_of(level_mesh(sphere_hlod(), 2), view_);
  EXPECT_GT(different_pixels(view_, coarse.depth, depth_of_level(*device, 0)), 100U);
}

// An eye far from the object's origin, a placement that cancels that, mirrors and squeezes: single precision alone
// would move vertices by many pixels.
TEST_P(HlodPicture, FarFromTheOriginNothingMoves) {
  const glm::dvec3 far(1e7, -3e7, 2e7);
  glm::dmat4 placement = glm::translate(glm::dmat4(1.0), far);
  placement = glm::scale(placement, glm::dvec3(-0.7, 1.0, 1.2));
  Camera camera = view_.camera();
  camera.eye += far;
  camera.target += far;
  view_ = View(camera);
  const auto device = make();
  begin(*device, sphere_hlod(), placement);
  draw_level(*device, sphere_hlod(), 0);
  static_cast<void>(device->end_frame());
  Camera near = sphere_view().camera();
  const ItemBuffer expected =
      items_of(level_mesh(sphere_hlod(), 0), View(near), glm::scale(glm::dmat4(1.0), glm::dvec3(-0.7, 1.0, 1.2)));
  EXPECT_EQ(different_pixels(view_, expected.depth, device->read_depth()), 0U);
}

TEST_P(HlodPicture, OrthographicViewsWork) {
  view_ = View(orthographic(view_.camera()));
  const auto device = make();
  const ItemBuffer expected = items_of(level_mesh(sphere_hlod(), 0), view_);
  EXPECT_EQ(different_pixels(view_, expected.depth, depth_of_level(*device, 0)), 0U);
}

// All of the sphere is in the image: with several samples a pixel at the border may show what is beyond it.
TEST_P(HlodPicture, OffCentreViewsWork) {
  Camera camera = view_.camera();
  camera.principal_point = {0.2, -0.1};
  view_ = View(camera);
  const auto device = make();
  const ItemBuffer expected = items_of(level_mesh(sphere_hlod(), 0), view_);
  EXPECT_EQ(different_pixels(view_, expected.depth, depth_of_level(*device, 0)), 0U);
  EXPECT_GT(count_visible_items(expected, 100'000), 100U);
}

// Half way, and at the end where the parents' meshes have the same triangles but for those that vanish.
TEST_P(HlodPicture, MorphsSlideToTheParents) {
  const auto device = make();
  for (const float morph : {0.25F, 0.5F}) {
    SCOPED_TRACE(morph);
    const ItemBuffer expected = items_of(level_mesh(sphere_hlod(), 0, morph), view_);
    EXPECT_EQ(different_pixels(view_, expected.depth, depth_of_level(*device, 0, morph)), 0U);
  }
  const DepthBuffer merged = depth_of_level(*device, 0, 1.0F);
  const DepthBuffer parents = depth_of_level(*device, 1);
  // The same but for rounding: corners of triangles may run in another order.
  for (std::size_t i = 0; i < merged.nearness.size(); ++i)
    ASSERT_NEAR(merged.nearness[i], parents.nearness[i], 1e-5F * parents.nearness[i]) << i;
  EXPECT_NE(merged.nearness, depth_of_level(*device, 0).nearness);
}

// Ranges of one draw: each with its own factor, adjacent and apart.
TEST_P(HlodPicture, RangesOfANodeMorphOnTheirOwn) {
  const hlod::Hlod& hlod = sphere_hlod();
  const auto device = make();
  std::size_t several = 0;
  for (const float second : {0.0F, 1.0F}) {
    // Even patches as they are, odd ones by `second`; left out is every third.
    const auto factor = [&](std::size_t patch) { return patch % 2 == 0 ? 0.0F : second; };
    begin(*device, hlod);
    TriangleMesh expected;
    for (hlod::NodeId n = hlod.data().levels[0].first_node; n < hlod.node_count(); ++n) {
      const hlod::NodeMesh mesh = hlod.mesh(n);
      std::vector<hlod::DrawRange> ranges;
      for (std::size_t p = 0; p < hlod.patches(n).size(); ++p) {
        if (p % 3 == 2) continue;
        const hlod::Patch& patch = hlod.patches(n)[p];
        ranges.push_back({patch.first_index, patch.index_count, factor(p)});
        for (std::uint32_t i = patch.first_index; i < patch.first_index + patch.index_count; ++i) {
          const std::uint16_t v = mesh.indices[i];
          const bool moves = factor(p) == 1.0F && mesh.merged_into[v] != hlod::stays;
          if (i % 3 == 0) expected.triangles.emplace_back();
          expected.triangles.back()[static_cast<int>(i % 3)] = static_cast<VertexId>(expected.positions.size());
          expected.positions.push_back(moves ? hlod.mesh(patch.parent).positions[mesh.merged_into[v]]
                                             : mesh.positions[v]);
        }
      }
      if (ranges.size() > 1) ++several;
      device->draw({0, n, ranges});
    }
    static_cast<void>(device->end_frame());
    // Samples beside the centres of pixels fall into gaps that are narrower than a pixel.
    EXPECT_LE(different_pixels(view_, items_of(expected, view_).depth, device->read_depth()),
              GetParam().quality ? 200U : 0U);
  }
  EXPECT_GT(several, 20U);
}

// Nodes refined within, by turns with the nodes as they are.
TEST_P(HlodPicture, NodesAreRefinedWithin) {
  hlod::HlodBuildOptions options;
  options.node_triangles = 64;
  options.within = hlod::Within::splits;
  const hlod::Hlod hlod = hlod::build_hlod(test::noisy_sphere(5, 1), options);
  const hlod::Level& level = hlod.data().levels[2];
  const auto device = make();
  const auto draw = [&](std::uint32_t share) {
    TriangleMesh expected;
    begin(*device, hlod);
    for (hlod::NodeId n = level.first_node; n < level.first_node + level.node_count; ++n) {
      ASSERT_TRUE(hlod.has_within(n));
      const hlod::NodeCut cut = hlod::cut_with_splits(hlod, n, hlod.data().within[n].splits * share / 4);
      device->draw({0, n, {}, cut.indices, cut.splits});
      const auto first = static_cast<VertexId>(expected.positions.size());
      for (const auto& positions : {hlod.mesh(n).positions, hlod.within(n).positions})
        expected.positions.insert(expected.positions.end(), positions.begin(), positions.end());
      for (std::size_t i = 0; i < cut.indices.size(); i += 3)
        expected.triangles.emplace_back(first + cut.indices[i], first + cut.indices[i + 1], first + cut.indices[i + 2]);
    }
    static_cast<void>(device->end_frame());
    EXPECT_EQ(different_pixels(view_, items_of(expected, view_).depth, device->read_depth()), 0U) << share;
  };
  for (const std::uint32_t share : {1U, 3U, 4U, 1U}) {
    draw(share);
    begin(*device, hlod);
    draw_level(*device, hlod, 2, 0.5F);
    static_cast<void>(device->end_frame());
    EXPECT_EQ(different_pixels(view_, items_of(level_mesh(hlod, 2, 0.5F), view_).depth, device->read_depth()), 0U);
  }
  // Each was uploaded once: three cuts and the node's own.
  EXPECT_EQ(device->mesh_memory().uploads, 4 * level.node_count);
}

// A wall seen along its normal. Lights as in shade.cpp: 0.12 of the head light, 0.98 of the key light, half way between
// both skies; with `quality` the sky is another sum.
TEST_P(HlodPicture, AWallHasTheLightOfShade) {
  Camera camera = test_view().camera();
  camera.orthographic_height = 4.0;
  view_ = View(camera);
  const hlod::Hlod hlod = hlod_of(wall());
  const auto device = make();
  begin(*device, hlod);
  draw_node(*device, 0, hlod, 0);
  static_cast<void>(device->end_frame());
  const Image image = device->read_image();
  const TriangleMesh mesh = level_mesh(hlod, 0);
  const std::array<DrawObject, 1> objects{{{mesh.positions, {}, mesh.triangles}}};
  const Image expected = shade(items_of(mesh, view_), objects, view_, {.wire = false});
  const std::size_t middle = 24 * 64 + 32;
  const int tolerance = GetParam().quality ? 24 : 8;  // a gamma of 2 is off by up to 7 of 255
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(image.pixels[middle][c], expected.pixels[middle][c], tolerance);
    // The background's corners.
    EXPECT_NEAR(image.pixels.front()[c], expected.pixels.front()[c], 1);
    EXPECT_NEAR(image.pixels.back()[c], expected.pixels.back()[c], 1);
  }
  EXPECT_EQ(image.pixels[middle].w, 255);
}

// Upright, not mirrored: a triangle in the upper left of the image.
TEST_P(HlodPicture, RowsRunFromTheTop) {
  Soup soup;
  soup.positions = {{-0.9F, 0.1F, 0}, {-0.1F, 0.1F, 0}, {-0.9F, 0.9F, 0}};
  soup.triangles = {{0, 1, 2}};
  const hlod::Hlod hlod = hlod_of(soup);
  view_ = test_view();
  const auto device = make();
  begin(*device, hlod);
  draw_node(*device, 0, hlod, 0);
  static_cast<void>(device->end_frame());
  const DepthBuffer depth = device->read_depth();
  const Image image = device->read_image();
  std::size_t covered = 0;
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * 64 + static_cast<std::size_t>(x);
      if (depth.nearness[pixel] == 0.0F) continue;
      ++covered;
      EXPECT_NEAR(depth.nearness[pixel], 1.0F / 3.0F, 1e-5F);
      EXPECT_TRUE(x < 32 && y < 24) << x << " " << y;
      EXPECT_NE(image.pixels[pixel], image.pixels[64 * 48 - 1]);
    }
  // Half of 0.8 x 0.8 units, which are 15.5 pixels, give or take half a pixel along all sides.
  EXPECT_NEAR(static_cast<double>(covered), 0.32 / (pixel_at_wall * pixel_at_wall), 26.0);
}

TEST_P(HlodPicture, VertexColoursAreSeen) {
  const auto painted = [](const glm::u8vec4& color) {
    TriangleMesh mesh;
    mesh.positions = wall().positions;
    mesh.triangles = wall().triangles;
    mesh.colors.assign(4, color);
    return hlod::build_hlod(mesh);
  };
  view_ = test_view();
  const auto device = make();
  const std::array<hlod::Hlod, 2> walls{painted({255, 0, 0, 255}), painted({0, 0, 255, 255})};
  for (const std::size_t i : {0U, 1U}) {
    begin(*device, walls[i]);
    draw_node(*device, 0, walls[i], 0);
    static_cast<void>(device->end_frame());
    const glm::u8vec4 middle = device->read_image().pixels[24 * 64 + 32];
    EXPECT_GT(middle[i == 0 ? 0 : 2], 100);
    EXPECT_EQ(middle[i == 0 ? 2 : 0], 0);
  }
}

}  // namespace
}  // namespace occlod::gl
