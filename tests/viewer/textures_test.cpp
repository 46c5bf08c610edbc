// What the viewer makes of wedges and materials.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "explain.h"
#include "hlod/store/hlod_data.h"
#include "layered_texture.h"
#include "mesh/image_codec.h"
#include "node_pictures.h"
#include "objects.h"
#include "occlod/build_hierarchy.h"
#include "support/wedge_meshes.h"
#include "viewer/support.h"

namespace occlod::viewer {
namespace {

std::shared_ptr<const Hierarchy> cylinder() {
  TriangleMesh mesh = occlod::test::cylinder_with_seam(32, 6);
  mesh.normals.clear();
  return std::make_shared<const Hierarchy>(build_hierarchy(mesh));
}

// The texture ends there, the surface does not: both wedges have the normal of the vertex, and no crease.
TEST(ViewMesh, SeamsAreNoEdgesOfTheSurface) {
  const auto hierarchy = cylinder();
  ASSERT_TRUE(hierarchy->has_seams());
  const auto mesh = make_view_mesh(hierarchy);
  ASSERT_EQ(mesh->normals.size(), hierarchy->wedge_count());
  ASSERT_EQ(mesh->creases.size(), hierarchy->wedge_count());
  for (WedgeId w = static_cast<WedgeId>(hierarchy->vertex_count()); w < hierarchy->wedge_count(); ++w) {
    const VertexId v = hierarchy->vertex_of_wedge(w);
    EXPECT_EQ(mesh->normals[w], mesh->normals[v]);
    EXPECT_EQ(mesh->creases[w], mesh->creases[v]);
  }
  // 32 sides meet at 11.25 degrees; an edge taken for a border of the surface would not count at all.
  for (const std::uint8_t crease : mesh->creases) EXPECT_LT(crease * 180.0 / 255.0, 12.0);
}

// Triangles name wedges, and the ids of extra ones are no splits: the last of the three vertices is the split's.
TEST(BornSplits, AreThoseOfVerticesNotOfWedges) {
  const auto hierarchy = cylinder();
  const std::vector<Triangle> triangles = wedge_triangles_of(*hierarchy, full_cut(*hierarchy));
  const std::vector<SplitId> born = born_splits(*hierarchy, triangles);
  std::size_t of_extra_wedges = 0;
  for (std::size_t i = 0; i < born.size(); ++i) {
    VertexId last = 0;
    for (int k = 0; k < 3; ++k) {
      last = std::max(last, hierarchy->vertex_of_wedge(triangles[i][k]));
      if (triangles[i][k] >= hierarchy->vertex_count()) ++of_extra_wedges;
    }
    if (last < hierarchy->base_vertex_count())
      EXPECT_EQ(born[i], no_id);
    else
      EXPECT_EQ(hierarchy->vertex_of(born[i]), last);
  }
  EXPECT_GT(of_extra_wedges, 0U);
}

// With all splits applied nothing has slipped; of the base mesh, whose texture is stretched, something has. Its errors
// of shape are others.
TEST(ErrorsPx, OfAttributesAreThoseOfTheNextSplits) {
  PlacedObject object;
  object.mesh = make_view_mesh(cylinder());
  const Hierarchy& hierarchy = *object.mesh->hierarchy;
  Camera camera;
  camera.eye = {0.0, 0.0, 10.0};
  const View view(camera);
  RefinedObject base;
  const FixedCut none{std::vector<bool>(hierarchy.split_count()), 0, hierarchy.base_triangle_count()};
  base.triangles = wedge_triangles_of(hierarchy, none);
  const std::vector<double> slips = errors_px(object, base, view, ErrorOf::attributes);
  EXPECT_GT(*std::max_element(slips.begin(), slips.end()), 0.0);
  EXPECT_NE(slips, errors_px(object, base, view));
  RefinedObject full;
  full.triangles = wedge_triangles_of(hierarchy, full_cut(hierarchy));
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) full.splits.push_back(s);
  for (const double slip : errors_px(object, full, view, ErrorOf::attributes)) EXPECT_EQ(slip, 0.0);
}

// Every layer is as large as the largest image, a power of two; one without an image is its base colour.
TEST(LayeredTexture, HasALayerForEachMaterial) {
  Image image{3, 4, {}};
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 3; ++x)
      image.pixels.push_back(y < 2 ? glm::u8vec4(255, 0, 0, 255) : glm::u8vec4(0, 0, 255, 255));
  for (const TextureOrigin origin : {TextureOrigin::bottom_left, TextureOrigin::top_left}) {
    const TextureImage texture(image, {.origin = origin});
    const std::array<DrawMaterial, 2> materials = {
        {{glm::vec3(0.0F, 1.0F, 0.0F), nullptr}, {glm::vec3(1.0F), &texture}}};
    const auto layers = layered(materials, origin);
    ASSERT_TRUE(layers);
    ASSERT_EQ(layers->size, 4);
    ASSERT_EQ(layers->layers.size(), 2U);
    EXPECT_EQ(layers->layers[0].pixels[5], glm::u8vec4(0, 255, 0, 255));
    // Its first row is the image's whichever way coordinates grow; between rows 1 and 2 red blends into blue.
    EXPECT_EQ(layers->layers[1].pixels[4].z, 0);
    EXPECT_EQ(layers->layers[1].pixels[8].x, 0);
  }
}

TEST(LayeredTexture, OfNothingIsNothing) { EXPECT_EQ(layered({}, TextureOrigin::bottom_left), nullptr); }

class NodePicturesOf : public ::testing::Test {
 protected:
  NodePicturesOf() { set_hlod(read_ohlod(test::write_sheet(folder_, "sheet.ohlod", OhlodImages::nodes)).hlod); }
  void set_hlod(hlod::Hlod hlod) {
    hlod_ = std::move(hlod);
    draws_.clear();
    for (hlod::NodeId n = 0; n < hlod_.node_count(); ++n) {
      hlod_.require(n);
      if (hlod_.node(n).level == 0) draws_.push_back({.object = 0, .node = n});
    }
  }
  [[nodiscard]] auto of(std::size_t max_bytes = node_picture_bytes) {
    const hlod::PlacedHlod placed[] = {{.hlod = &hlod_}};
    return pictures_.of(draws_, placed, max_bytes);
  }
  static std::size_t bytes_of(std::span<const std::shared_ptr<const Image>> images) {
    std::size_t bytes = 0;
    for (const auto& image : images) bytes += image ? std::span(image->pixels).size_bytes() : 0;
    return bytes;
  }

  test::Folder folder_;
  hlod::Hlod hlod_;
  std::vector<hlod::DrawnNode> draws_;
  NodePictures pictures_;
};

TEST_F(NodePicturesOf, LiveAsLongAsSomeoneHasThem) {
  draws_.push_back(draws_[0]);  // of another object with the same HLOD, say
  draws_.push_back(draws_[1]);
  draws_.back().splits = 1;  // a cut
  auto images = of();
  ASSERT_EQ(images.size(), draws_.size());
  for (std::size_t i = 0; i + 1 < images.size(); ++i) ASSERT_TRUE(images[i]) << i;
  EXPECT_EQ(images[images.size() - 2], images[0]);
  EXPECT_EQ(images.back(), nullptr);
  const auto held = images[2];
  const std::weak_ptr<const Image> let_go = images[3];
  images.clear();
  EXPECT_TRUE(let_go.expired());
  EXPECT_EQ(of()[2], held);
}

// What no triangle shows is black in the file, and a mean of what is shown here: the sheet's image is nowhere without
// blue.
TEST_F(NodePicturesOf, NoTexelIsBlack) {
  const auto has_black = [](const auto& pixels) {
    return std::ranges::any_of(pixels, [](const glm::u8vec4& pixel) { return pixel.b < 38; });
  };
  for (const hlod::DrawnNode& draw : draws_)
    EXPECT_TRUE(has_black(decode_texels(hlod_.mesh(draw.node).image, "image").pixels));
  for (const auto& image : of()) EXPECT_FALSE(has_black(image->pixels));
}

// Red grows along x, and all of the sheet is shown: the mean over nodes stays where it was.
TEST_F(NodePicturesOf, AllAreHalvedUntilTheyFit) {
  const auto whole = of();
  const std::size_t bytes = bytes_of(whole);
  EXPECT_EQ(of(bytes), whole);
  const auto half = of(bytes - 1);
  EXPECT_LT(bytes_of(half), bytes / 3);
  EXPECT_GT(bytes_of(half), bytes / 6);
  EXPECT_LE(bytes_of(of(bytes / 40)), bytes / 40);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(half[i]->width, whole[i]->width / 2);
    const auto middle = [](const Image& image) {
      return image.pixels[static_cast<std::size_t>(image.height / 2 * image.width + image.width / 2)];
    };
    EXPECT_NEAR(middle(*half[i]).r, middle(*whole[i]).r, 3);
    EXPECT_NEAR(middle(*half[i]).g, middle(*whole[i]).g, 3);
  }
}

TEST_F(NodePicturesOf, NodesWithABrokenImageAreNull) {
  hlod::HlodData data = copy_data(hlod_);
  const hlod::NodeId broken = draws_[1].node;
  const std::uint64_t image = data.node_images[broken].place + 4 * data.nodes[broken].vertices;
  std::fill_n(data.images.begin() + static_cast<std::ptrdiff_t>(image), 8, std::byte{0});
  set_hlod(make_hlod(std::move(data)));
  for (int i = 0; i < 2; ++i) {  // it is told once
    testing::internal::CaptureStderr();
    const auto images = of();
    const std::string told = testing::internal::GetCapturedStderr();
    EXPECT_EQ(images[1], nullptr);
    EXPECT_TRUE(images[0] && images[2]);
    EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), i == 0 ? 1 : 0) << told;
  }
}

}  // namespace
}  // namespace occlod::viewer
