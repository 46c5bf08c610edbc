// Materials of OBJ files: usemtl and mtllib.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "io/mesh_files.h"
#include "occlod/build_hierarchy.h"
#include "support/wedges.h"

namespace occlod {
namespace {

constexpr const char* square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
constexpr const char* halves[] = {"f 1 2 3\n", "f 1 3 4\n"};

Texture texture(const std::string& file, TextureWrap wrap = TextureWrap::repeat) {
  Texture result;
  result.file = file;
  result.wrap_s = result.wrap_t = wrap;
  return result;
}

class ReadMtl : public testing::Test {
 protected:
  [[nodiscard]] CleanMesh read(const std::string& text) const { return folder_.read("a.obj", text); }
  // The material m of a mesh whose library has this text.
  [[nodiscard]] CleanMesh with_library(const std::string& library) const {
    static_cast<void>(folder_.write("a.mtl", library));
    return read(std::string("mtllib a.mtl\n") + square + "usemtl m\n" + halves[0] + halves[1]);
  }
  // "place: problem" of a library that is refused.
  [[nodiscard]] std::string complaint(const std::string& library) const {
    return test::complaint_of(folder_.path() / "a.mtl", [&] { static_cast<void>(with_library(library)); });
  }

  test::TestFolder folder_;
};

// Faces before the first usemtl have a material without a name. Both ends of the diagonal have a wedge for each.
TEST_F(ReadMtl, NamesMaterialsInTheOrderOfTheFile) {
  const CleanMesh result = read(std::string(square) + halves[0] + "usemtl b c\nusemtl a\n" + halves[1]);
  ASSERT_EQ(result.mesh.materials.size(), 3u);
  EXPECT_EQ(result.mesh.materials[0], Material{});
  EXPECT_EQ(result.mesh.materials[1].name, "b c");
  EXPECT_EQ(result.mesh.materials[2].name, "a");
  EXPECT_EQ(result.mesh.triangle_materials, (std::vector<MaterialId>{0, 2}));
  EXPECT_EQ(test::wedge_problem(result.mesh), "");
  EXPECT_EQ(result.mesh.extra_wedges, (std::vector<VertexId>{0, 2}));
}

// One material for all needs no array; a name that comes again is the same material; triangles of polygons have theirs.
TEST_F(ReadMtl, GivesEachTriangleItsMaterial) {
  EXPECT_TRUE(read(std::string("usemtl a\n") + square + "f 1 2 3 4\n").mesh.triangle_materials.empty());
  const CleanMesh result =
      read(std::string("usemtl a\n") + square + "f 1 2 3 4\nusemtl b\nf 3 2 1\nusemtl a\nf 4 3 2 1\n");
  EXPECT_EQ(result.mesh.triangle_materials, (std::vector<MaterialId>{0, 0, 1, 0, 0}));
}

TEST_F(ReadMtl, ReadsColourOpacityAndTexture) {
  const CleanMesh result = with_library(
      "# a comment\nnewmtl other\nKd 1 0 0\n\nnewmtl m\n  Ka 1 1 1\nKd 0.5 1 0\nKs 1\nd 0.25\nillum 2\n"
      "map_Ks no.png\nmap_Kd wood.png\n");
  ASSERT_EQ(result.mesh.materials.size(), 1u);
  const Material& m = result.mesh.materials[0];
  EXPECT_EQ(m.name, "m");
  EXPECT_FLOAT_EQ(m.base_color.r, 0.21404114F);  // ((0.5 + 0.055) / 1.055)^2.4
  EXPECT_EQ(m.base_color.g, 1.0F);
  EXPECT_EQ(m.base_color.b, 0.0F);
  EXPECT_EQ(m.base_color.a, 0.25F);
  ASSERT_EQ(m.texture, 0u);
  ASSERT_EQ(result.mesh.textures.size(), 1u);
  EXPECT_EQ(result.mesh.textures[0], texture("wood.png"));
  EXPECT_EQ(result.mesh.texture_origin, TextureOrigin::bottom_left);
  LeftOut left_out;
  for (const char* const name : {"unused materials (newmtl)", "Ka", "Ks", "illum", "map_Ks"}) left_out.add(name);
  EXPECT_EQ(result.report.left_out, left_out);
}

// As several programs write them.
TEST_F(ReadMtl, KeywordsMayBeInAnyCase) {
  const CleanMesh result = with_library("NEWMTL m\nkd 1 0 0\nD 0.5\nMAP_KD a.png\n");
  EXPECT_EQ(result.mesh.materials.at(0).base_color, glm::vec4(1, 0, 0, 0.5F));
  EXPECT_EQ(result.mesh.textures.at(0).file, "a.png");
  EXPECT_EQ(result.report.left_out, LeftOut{});
}

TEST_F(ReadMtl, CountsWhatItDoesNotReadByKeyword) {
  const LeftOut counts = with_library(
                             "Ns 1\nnewmtl m\nmap_d a.png\nmap_Pm n.png\nmap_Bump -bm 1 b.png\nmap_Pr r.png\n"
                             "map_Kd -mm 0 1 -clamp on -texres 5 c.png\nKd spectral a.rfl\nd -halo 0.5\nmap_d d.png\n")
                             .report.left_out;
  LeftOut expected;
  for (const char* const name : {"Ns", "map_d", "map_d", "map_Pm", "map_Bump", "map_Pr", "map_Kd -mm", "map_Kd -texres",
                                 "Kd spectral", "d -halo"})
    expected.add(name);
  EXPECT_EQ(counts, expected);
}

// Bytes of file names are kept, so that the file is found, through a hierarchy too; names of materials become UTF-8, so
// that a library in Latin-1 fits an OBJ in UTF-8.
TEST_F(ReadMtl, NamesMayBeLatin1) {
  static_cast<void>(folder_.write("a.mtl",
                                  "newmtl Stra\xdf"
                                  "e\nmap_Kd Stra\xdf"
                                  "e.png\n"));
  for (const char* const name : {"Stra\xdf"
                                 "e",
                                 "Stra\u00dfe"}) {
    const CleanMesh result =
        read(std::string("mtllib a.mtl\n") + square + "usemtl " + name + "\n" + halves[0] + halves[1]);
    EXPECT_EQ(result.mesh.materials.at(0).name, "Stra\u00dfe");
    EXPECT_EQ(result.mesh.textures.at(0).file,
              "Stra\xdf"
              "e.png");
    EXPECT_EQ(result.report.left_out, LeftOut{});
    write_olod(folder_.path() / "a.olod", build_hierarchy(result.mesh), result.report);
    EXPECT_EQ(read_olod(folder_.path() / "a.olod").hierarchy.data().textures[0].file,
              "Stra\xdf"
              "e.png");
    write_mesh(folder_.path() / "b.obj", result.mesh);
    EXPECT_EQ(read_mesh(folder_.path() / "b.obj").mesh.textures.at(0).file,
              "Stra\xdf"
              "e.png");
  }
}

// In GBK the second byte of a character may be a backslash: the file that has the name tells.
TEST_F(ReadMtl, BackslashesStayWhereAFileHasThem) {
  for (const char* const name : {"\xb1\\.png", "maps\\a.png"}) {
    const std::string library = std::string("newmtl m\nmap_Kd ") + name + "\n";
    std::string with_slash = name;
    std::ranges::replace(with_slash, '\\', '/');
    EXPECT_EQ(with_library(library).mesh.textures.at(0).file, with_slash);
    static_cast<void>(folder_.write(name, "image"));
    EXPECT_EQ(with_library(library).mesh.textures.at(0).file, name);
  }
}

TEST_F(ReadMtl, TakesEveryFormOfColourAndOpacity) {
  const auto color = [&](const std::string& line) {
    return with_library("newmtl m\n" + line + "\n").mesh.materials.at(0).base_color;
  };
  EXPECT_EQ(color("Kd 0 # black"), glm::vec4(0, 0, 0, 1));
  EXPECT_EQ(color("Kd 2 -1 nan"), glm::vec4(1, 0, 0, 1));  // clamped
  EXPECT_EQ(color("Kd spectral a.rfl 1"), glm::vec4(1, 1, 1, 1));
  EXPECT_EQ(color("Kd xyz 0 0 0"), glm::vec4(1, 1, 1, 1));
  EXPECT_EQ(color("d -halo 0.5"), glm::vec4(1, 1, 1, 0.5F));
  EXPECT_EQ(color("Tr 0.25"), glm::vec4(1, 1, 1, 0.75F));
  EXPECT_EQ(color("d 1.0\nTr 1.0"), glm::vec4(1, 1, 1, 1));  // as 3ds Max writes what is opaque
}

// Maps are placed relative to the base colour, whose scale and offset the coordinates have: where they are c = 2u - 1
// and d = 4v, a map at 8u and v + 0.5 is at 4c + 4 and 0.25d + 0.5, which is 0.25d + 0.25 where
// both grow downwards.
TEST_F(ReadMtl, ReadsLightNormalsAndGloss) {
  const auto material = [&](const std::string& lines) {
    return with_library("newmtl m\n" + lines).mesh.materials.at(0);
  };
  const CleanMesh result = with_library("newmtl m\nPr 0.25\nPm 2\nKe 1 0 0.5\nmap_Ke -clamp on e.png\nNORM n.png\n");
  const Surface& surface = result.mesh.materials.at(0).surface;
  EXPECT_EQ(surface.roughness, 0.25F);
  EXPECT_EQ(surface.metallic, 1.0F);
  EXPECT_EQ(surface.emissive.r, 1.0F);
  EXPECT_FLOAT_EQ(surface.emissive.b, 0.21404114F);  // as for Kd
  EXPECT_EQ(result.mesh.materials[0].texture, no_texture);
  EXPECT_EQ(result.mesh.textures.at(surface.normal_map.texture), texture("n.png"));
  EXPECT_EQ(result.mesh.textures.at(surface.emissive_map.texture), texture("e.png", TextureWrap::clamp));
  EXPECT_EQ(surface.normal_map, TextureMap{.texture = surface.normal_map.texture});
  EXPECT_EQ(result.report.left_out, LeftOut{});

  EXPECT_EQ(material("map_Ke e.png\n").surface.emissive, glm::vec3(1.0F));
  EXPECT_EQ(material("map_Ke\n").surface, Surface{});
  EXPECT_EQ(material("Ke 0 0 0\nmap_Ke e.png\n").surface.emissive, glm::vec3(0.0F));
  EXPECT_EQ(material("map_Ke e.png\nKe 0 0 1\n").surface.emissive, glm::vec3(0.0F, 0.0F, 1.0F));
  LeftOut bright;
  bright.add("Ke above 1 (clamped)");
  EXPECT_EQ(with_library("newmtl m\nKe 0 0 7\n").report.left_out, bright);

  const std::string color = "map_Kd -s 2 4 -o -1 0 a.png\n";
  EXPECT_EQ(material(color + "norm -s 2 4 -o -1 a.png\n").surface.normal_map, TextureMap{.texture = 0});
  const TextureMap placed = material(color + "norm -s 8 1 -o 0 0.5 a.png\n").surface.normal_map;
  EXPECT_EQ(placed.scale, glm::vec2(4.0F, 0.25F));
  EXPECT_EQ(placed.offset, glm::vec2(4.0F, 0.25F));
  LeftOut flat;
  flat.add("norm beside map_Kd -s 0");
  EXPECT_EQ(with_library("newmtl m\nmap_Kd -s 0 1 a.png\nnorm a.png\n").report.left_out, flat);
}

TEST_F(ReadMtl, TakesEveryNameOfATexture) {
  const auto file = [&](const std::string& line) {
    return with_library("newmtl m\nmap_Kd " + line + "\n").mesh.textures.at(0).file;
  };
  EXPECT_EQ(file("a b.png"), "a b.png");
  EXPECT_EQ(file("\"a b.png\" "), "a b.png");
  EXPECT_EQ(file("maps\\a.png"), "maps/a.png");
  EXPECT_EQ(file("-s 1 2 3 -o 0.5 a b.png"), "a b.png");
  EXPECT_EQ(file("-bm 0.2 -blendu on -mm 0 1 -texres 512 -imfchan r -type sphere 7.png"), "7.png");
  EXPECT_TRUE(with_library("newmtl m\nmap_Kd\n").mesh.textures.empty());
  const Texture clamped = with_library("newmtl m\nmap_Kd -clamp on a.png\n").mesh.textures.at(0);
  EXPECT_EQ(clamped, texture("a.png", TextureWrap::clamp));
}

// Two materials with one texture share it; one that repeats it otherwise has its own.
TEST_F(ReadMtl, SharesTextures) {
  static_cast<void>(
      folder_.write("a.mtl", "newmtl a\nmap_Kd t.png\nnewmtl b\nmap_Kd t.png\nnewmtl c\nmap_Kd -clamp on t.png\n"));
  const TriangleMesh mesh =
      read(std::string("mtllib a.mtl\n") + square + "usemtl c\n" + halves[0] + "usemtl a\n" + halves[1] + "usemtl b\n")
          .mesh;
  ASSERT_EQ(mesh.textures.size(), 2u);
  EXPECT_EQ(mesh.materials[1].texture, mesh.materials[2].texture);
  EXPECT_NE(mesh.materials[0].texture, mesh.materials[1].texture);
}

// What is missing costs the look, not the mesh: the names stay, and what has no description counts as left out.
TEST_F(ReadMtl, GoesWithoutALibrary) {
  const std::string rest = std::string(square) + "usemtl a\n" + halves[0] + "usemtl b\n" + halves[1];
  const CleanMesh missing = read("mtllib no such.mtl\n" + rest);
  EXPECT_EQ(missing.report.left_out.count("undefined materials (usemtl)"), 2u);
  EXPECT_EQ(missing.mesh.materials.at(1).name, "b");
  static_cast<void>(folder_.write("b.mtl", "newmtl b\nKd 0 0 0\n"));
  EXPECT_EQ(read("mtllib b.mtl\n" + rest).report.left_out.count("undefined materials (usemtl)"), 1u);
  EXPECT_EQ(read(rest).report.left_out.count("undefined materials (usemtl)"), 2u);
  static_cast<void>(folder_.write("empty.mtl", ""));
  EXPECT_EQ(read("mtllib empty.mtl\n" + rest).report.left_out.count("undefined materials (usemtl)"), 2u);
}

// A name may have blanks and quotes; a line may have several; files are relative to the OBJ file, textures to theirs.
TEST_F(ReadMtl, FindsLibraries) {
  std::filesystem::create_directories(folder_.path() / "sub");
  static_cast<void>(folder_.write("my a.mtl", "newmtl a\nmap_Kd t.png\n"));
  static_cast<void>(folder_.write("sub/b.mtl", "newmtl b\nmap_Kd t.png\nnewmtl a\nmap_Kd later.png\n"));
  const std::string rest = std::string(square) + "usemtl a\n" + halves[0] + "usemtl b\n" + halves[1];
  for (const char* line :
       {"mtllib my a.mtl\nmtllib none.mtl sub\\b.mtl\n", "mtllib \"my a.mtl\"\nmtllib sub/b.mtl\n"}) {
    const TriangleMesh mesh = read(line + rest).mesh;
    ASSERT_EQ(mesh.textures.size(), 2u) << line;
    EXPECT_EQ(mesh.textures[mesh.materials[0].texture].file, "t.png");  // the first description counts
    EXPECT_EQ(mesh.textures[mesh.materials[1].texture].file, "sub/t.png");
  }
}

TEST_F(ReadMtl, NamesTheLineOfEveryFault) {
  EXPECT_CONTAINS(complaint("Kd 1 1 1\n"), "line 1: comes before the first newmtl");
  EXPECT_CONTAINS(complaint("newmtl m\nKd 1 x 1\n"), "line 2: a value of a material is 'x', which is not a number");
  EXPECT_CONTAINS(complaint("newmtl m\nKd\n"), "line 2: Kd has no colour");
  EXPECT_CONTAINS(complaint("newmtl m\nd\n"), "line 2: a value of a material is ''");
  EXPECT_CONTAINS(complaint("newmtl m\nTr 1,5\n"), "line 2: a value of a material is '1,5'");
  EXPECT_EQ(complaint("newmtl m\nKd 1 1 1 # white\nPr 0.5\nmap_Bump -bm 1 x.png\nweird\n"), "accepted");
}

TEST_F(ReadMtl, RefusesMoreMaterialsThanItCanCount) {
  std::string text = square;
  for (int i = 0; i < 65'535; ++i) text += "usemtl " + std::to_string(i) + "\n";
  EXPECT_EQ(read(text + halves[0]).mesh.materials.size(), 65'535u);
  EXPECT_CONTAINS(folder_.complaint("a.obj", text + "usemtl x\n" + halves[0]),
                  "line 65540: there are more than 65535 materials");
}

}  // namespace
}  // namespace occlod
