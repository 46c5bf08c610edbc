// What is written with its seams and materials is read again to the bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "io/mesh_files.h"
#include "occlod/mesh_file.h"
#include "support/meshes.h"
#include "support/test_meshes.h"
#include "support/wedges.h"

namespace occlod {
namespace {

using test::Corner;
using test::corners_of;

// A torus with its chart cut open, two materials, normals and every colour there is.
TriangleMesh painted_torus(bool with_colors) {
  const TriangleMesh torus = test::torus(9, 7);
  TriangleMesh soup;
  for (std::size_t t = 0; t < torus.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const VertexId v = torus.triangles[t][k];
      soup.positions.push_back(torus.positions[v]);
      soup.texture_coordinates.emplace_back(static_cast<float>(v % 9) / 9.0F + (t % 18 == 17 ? 1.0F : 0.0F),
                                            static_cast<float>(v) * 0.013F);
      soup.normals.push_back(glm::vec3(std::cos(static_cast<float>(v)), std::sin(static_cast<float>(v)), 0.0F));
      const auto shade = static_cast<std::uint8_t>(4 * v);
      if (with_colors) soup.colors.emplace_back(shade, 255 - shade, shade / 2 + 1, 255);
    }
    const auto first = static_cast<VertexId>(3 * t);
    soup.triangles.emplace_back(first, first + 1, first + 2);
    soup.triangle_materials.push_back(t % 30 < 15 ? 1 : 0);
  }
  soup.materials.resize(2);
  soup.materials[0] = {"red one", {1.0F, 0.03F, 0.0F, 0.5F}, 1};
  soup.materials[1] = {"other", {0.1F, 0.2F, 0.7F, 1.0F}, 0};
  soup.textures.resize(2);
  soup.textures[0].file = "maps/a b.png";
  soup.textures[1].file = "c.png";
  soup.textures[1].wrap_s = soup.textures[1].wrap_t = TextureWrap::clamp;
  return clean(std::move(soup), {}, "torus").mesh;
}

CleanMesh written_and_read(const test::TestFolder& folder, const std::string& name, const TriangleMesh& mesh) {
  write_mesh(folder.path() / name, mesh);
  CleanMesh back = read_mesh(folder.path() / name);
  EXPECT_EQ(test::wedge_problem(back.mesh), "") << name;
  return back;
}

// Each material with its texture. Readers number textures in the order in which materials name them.
std::vector<std::pair<Material, Texture>> looks_of(const TriangleMesh& mesh) {
  std::vector<std::pair<Material, Texture>> looks;
  for (Material material : mesh.materials) {
    const Texture texture = material.texture == no_texture ? Texture{} : mesh.textures.at(material.texture);
    material.texture = 0;
    looks.emplace_back(std::move(material), texture);
  }
  return looks;
}

std::vector<Corner> sorted(std::vector<Corner> corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

TEST(WriteWedges, ObjBringsBackEveryCorner) {
  const test::TestFolder folder;
  for (const bool with_colors : {false, true}) {
    const TriangleMesh mesh = painted_torus(with_colors);
    ASSERT_GT(mesh.extra_wedges.size(), 20U);
    const CleanMesh back = written_and_read(folder, "a.obj", mesh);
    EXPECT_EQ(corners_of(back.mesh), corners_of(mesh));
    EXPECT_TRUE(looks_of(back.mesh) == looks_of(mesh));
    EXPECT_EQ(back.mesh.vertex_count(), mesh.vertex_count());
    EXPECT_EQ(back.report.left_out, LeftOut{});
  }
  EXPECT_EQ(test::files_in(folder.path()), 2U);  // a.obj and a.mtl
}

// Materials of PLY are its textures.
TEST(WriteWedges, PlyBringsBackEveryCorner) {
  const test::TestFolder folder;
  const TriangleMesh mesh = painted_torus(true);
  const CleanMesh back = written_and_read(folder, "a.ply", mesh);
  EXPECT_EQ(back.mesh.textures.at(0).file, "maps/a b.png");
  std::vector<Corner> expected = corners_of(mesh);
  for (Corner& corner : expected) corner.material = static_cast<MaterialId>(mesh.materials[corner.material].texture);
  EXPECT_EQ(corners_of(back.mesh), expected);
  // One texture for all needs no numbers.
  TriangleMesh plain = mesh;
  plain.triangle_materials.clear();
  plain.materials.resize(1);
  plain.textures.resize(1);
  plain.materials[0].texture = 0;
  plain = clean(std::move(plain), {}, "plain").mesh;
  const CleanMesh one = written_and_read(folder, "b.ply", plain);
  EXPECT_EQ(corners_of(one.mesh), corners_of(plain));
  EXPECT_EQ(test::bytes_of(folder.path() / "b.ply").find("texnumber"), std::string::npos);
  EXPECT_EQ(one.mesh.textures.size(), 1U);
}

// Triangles are sorted by material. Its origin is at the top: v is written as 1 - v unless the mesh has it there too.
TEST(WriteWedges, GlbBringsBackEveryCorner) {
  const test::TestFolder folder;
  TriangleMesh mesh = painted_torus(true);
  for (Material& material : mesh.materials) material.base_color.a = 0.75F;
  const TriangleMesh flipped = written_and_read(folder, "a.glb", mesh).mesh;
  std::vector<Corner> expected = corners_of(mesh);
  for (Corner& corner : expected) corner.texture_coordinate.y = 1.0F - corner.texture_coordinate.y;
  EXPECT_EQ(sorted(corners_of(flipped)), sorted(expected));
  EXPECT_EQ(flipped.texture_origin, TextureOrigin::top_left);
  EXPECT_TRUE(looks_of(flipped) == looks_of(mesh));
  const TriangleMesh again = written_and_read(folder, "b.glb", flipped).mesh;
  EXPECT_EQ(corners_of(again), corners_of(flipped));
  EXPECT_TRUE(looks_of(again) == looks_of(flipped));
}

// All 256 shades of sRGB survive 16 bits of linear light.
TEST(WriteWedges, GlbKeepsEveryColour) {
  const test::TestFolder folder;
  TriangleMesh mesh = test::grid(16, 16);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const auto shade = static_cast<std::uint8_t>(v % 256);
    mesh.colors.emplace_back(shade, 255 - shade, shade ^ 85U, 255 - shade);
  }
  EXPECT_EQ(written_and_read(folder, "a.glb", mesh).mesh.colors, mesh.colors);
}

// More vertices than 16 bits count.
TEST(WriteWedges, GlbHasIndicesOf32Bits) {
  const test::TestFolder folder;
  const TriangleMesh mesh = test::grid(300, 300);
  const TriangleMesh back = written_and_read(folder, "a.glb", mesh).mesh;
  EXPECT_EQ(back.positions, mesh.positions);
  EXPECT_EQ(back.triangles, mesh.triangles);
}

// Inside GLB, and as files beside the others.
TEST(WriteWedges, ImagesOfTheMeshAreKept) {
  const test::TestFolder folder;
  TriangleMesh mesh = painted_torus(false);
  mesh.textures[0] = {};
  const std::string png = "\x89PNG and so on";
  mesh.textures[0].bytes.assign(png.begin(), png.end());
  const Texture inside = looks_of(written_and_read(folder, "a.glb", mesh).mesh).at(1).second;
  EXPECT_EQ(inside.bytes, mesh.textures[0].bytes);
  EXPECT_EQ(inside.mime_type, "image/png");
  for (const char* name : {"b.obj", "c.ply"}) {
    const TriangleMesh back = written_and_read(folder, name, mesh).mesh;
    const std::string file = std::string(1, name[0]) + "_0.png";
    EXPECT_TRUE(std::ranges::any_of(back.textures, [&](const Texture& texture) { return texture.file == file; }));
    EXPECT_EQ(test::bytes_of(folder.path() / file), png);
  }
}

// MTL has words for some of what glTF says of a surface; one note counts the materials of which more is lost.
TEST(WriteWedges, ObjHasMapsOfLightAndNormals) {
  const test::TestFolder folder;
  TriangleMesh mesh = painted_torus(false);
  mesh.textures.resize(3);
  mesh.textures[2].file = "light.png";
  Surface& surface = mesh.materials[0].surface;
  surface.metallic = 0.3F;
  surface.roughness = 0.7F;
  surface.emissive = {0.1F, 0.0F, 1.0F};
  surface.emissive_map.texture = 2;
  surface.normal_map = {.texture = 0, .offset = {0.3F, -0.7F}, .scale = {3.0F, 0.1F}};
  mesh.materials[1].surface.normal_map.texture = 2;
  EXPECT_EQ(write_mesh(folder.path() / "a.obj", mesh).size(), 3U);  // images that are not there
  const CleanMesh back = read_mesh(folder.path() / "a.obj");
  EXPECT_EQ(back.report.left_out, LeftOut{});
  for (std::size_t m = 0; m < 2; ++m) {
    Material expected = mesh.materials[m], read = back.mesh.materials.at(m);
    const std::array<TextureId, 5> before = expected.textures(), after = read.textures();
    for (std::size_t k = 0; k < 5; ++k) {
      ASSERT_EQ(after.at(k) == no_texture, before.at(k) == no_texture);
      if (after.at(k) != no_texture) {
        EXPECT_EQ(back.mesh.textures.at(after.at(k)).file, mesh.textures.at(before.at(k)).file);
      }
    }
    expected.texture = read.texture = 0;
    expected.surface.emissive_map.texture = read.surface.emissive_map.texture = 0;
    expected.surface.normal_map.texture = read.surface.normal_map.texture = 0;
    EXPECT_EQ(read, expected);
  }
  surface.normal_map.rotation = 1.0F;
  mesh.materials[1].surface.double_sided = true;
  EXPECT_EQ(write_mesh(folder.path() / "a.obj", mesh).at(0),
            ".obj has what .mtl has words for only: 2 of 2 materials have more (use .glb)");
  EXPECT_EQ(test::bytes_of(folder.path() / "a.mtl").find("norm -s"), std::string::npos);
  EXPECT_EQ(write_mesh(folder.path() / "a.ply", mesh).at(0),
            ".ply has textures of base colours only: 2 of 2 materials have more (use .glb)");
}

// Names that a reader would not find again are replaced; the others stay.
TEST(WriteWedges, ObjTellsMaterialsApart) {
  const test::TestFolder folder;
  TriangleMesh mesh = test::grid(5, 1);
  mesh.materials.resize(5);
  const char* const names[] = {"", "same", "same", "# no", "material_0"};
  for (std::size_t m = 0; m < 5; ++m) {
    mesh.materials[m].name = names[m];
    mesh.materials[m].base_color.r = 0.125F * static_cast<float>(m);
  }
  mesh.triangle_materials = {4, 4, 2, 2, 0, 0, 3, 3, 1, 1};
  mesh = clean(std::move(mesh), {}, "grid").mesh;
  const TriangleMesh back = written_and_read(folder, "a.obj", mesh).mesh;
  EXPECT_EQ(back.triangle_materials, mesh.triangle_materials);
  const char* const expected[] = {"material_0_", "same", "material_2", "material_3", "material_0"};
  for (std::size_t m = 0; m < 5; ++m) {
    EXPECT_EQ(back.materials.at(m).name, expected[m]);
    EXPECT_EQ(back.materials[m].base_color, mesh.materials[m].base_color);
  }
}

// OBJ and PLY to the bit; GLB but for the origin, and to the bit from then on.
TEST(WriteWedges, RealMeshesComeBack) {
  for (const char* file :
       {"textured/spot.obj", "textured/beast.obj", "scenes/sponza.obj", "hard/meshoptimizer__pirate.obj"}) {
    OCCLOD_FIND_TEST_MESH_OR_SKIP(path, file);
    SCOPED_TRACE(file);
    const test::TestFolder folder;
    const TriangleMesh mesh = read_mesh(path).mesh;
    EXPECT_FALSE(mesh.extra_wedges.empty());
    EXPECT_EQ(test::wedge_problem(mesh), "");
    const TriangleMesh obj = written_and_read(folder, "a.obj", mesh).mesh;
    EXPECT_EQ(corners_of(obj), corners_of(mesh));
    EXPECT_TRUE(looks_of(obj) == looks_of(mesh));
    const TriangleMesh glb = written_and_read(folder, "a.glb", mesh).mesh;
    const TriangleMesh again = written_and_read(folder, "b.glb", glb).mesh;
    EXPECT_EQ(corners_of(again), corners_of(glb));
    // PLY has no materials without textures.
    TriangleMesh plain = mesh;
    plain.materials.clear();
    plain.triangle_materials.clear();
    plain = clean(std::move(plain), {}, "plain").mesh;
    EXPECT_EQ(corners_of(written_and_read(folder, "a.ply", plain).mesh), corners_of(plain));
  }
}

}  // namespace
}  // namespace occlod
