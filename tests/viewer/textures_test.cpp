// What the viewer makes of wedges and materials.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "explain.h"
#include "layered_texture.h"
#include "objects.h"
#include "occlod/build_hierarchy.h"
#include "support/wedge_meshes.h"

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

}  // namespace
}  // namespace occlod::viewer
