// Nothing of a mesh file is dropped without a word: every element, property, keyword and type that PLY, OBJ, MTL, STL
// and OFF know, and that well-known programs add, is either carried, and the same after a round trip through our
// writers, or counted by its name. Sources: Turk's PLY files (1994), "Object Files" and "Material Library File" of
// Wavefront (appendix B1 and MTL), the StL specification of 3D Systems, and Geomview's manual for OFF.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "io/mesh_files.h"

namespace occlod {
namespace {

std::string in_words(const LeftOut& counts) {
  std::string words;
  for (const LeftOut::Entry& entry : counts.entries()) words += fmt::format("{} {}, ", entry.count, entry.name);
  return words;
}

class Names : public testing::Test {
 protected:
  // Expects that the file is read and leaves out so many of the name, and nothing else.
  void expect_counted(const std::string& file, const std::string& text, const std::string& name,
                      std::uint64_t count) const {
    try {
      LeftOut expected;
      expected.add(name, count);
      const LeftOut counts = folder_.read(file, text).report.left_out;
      EXPECT_EQ(counts, expected) << text << in_words(counts);
    } catch (const Error& error) {
      ADD_FAILURE() << error.what() << "\n" << text;
    }
  }

  // Expects that the file is read whole, and returns its mesh, which is the same after a round trip.
  [[nodiscard]] TriangleMesh carried(const std::string& file, const std::string& text, const char* writer) const {
    const CleanMesh input = folder_.read(file, text);
    EXPECT_EQ(input.report.left_out, LeftOut{}) << text << in_words(input.report.left_out);
    const std::filesystem::path path = folder_.path() / (std::string("again.") + writer);
    write_mesh(path, input.mesh);
    const TriangleMesh again = read_mesh(path).mesh;
    EXPECT_EQ(again.positions, input.mesh.positions) << text;
    EXPECT_EQ(again.triangles, input.mesh.triangles) << text;
    EXPECT_EQ(again.normals, input.mesh.normals) << text;
    EXPECT_EQ(again.colors, input.mesh.colors) << text;
    EXPECT_EQ(again.texture_coordinates, input.mesh.texture_coordinates) << text;
    EXPECT_EQ(again.triangle_materials, input.mesh.triangle_materials) << text;
    EXPECT_EQ(again.textures, input.mesh.textures) << text;
    return input.mesh;
  }

  test::TestFolder folder_;
};

// A triangle whose vertices and whose face have more properties, with these values in each.
std::string ply(const std::string& vertex, const std::string& values, const std::string& face = "",
                const std::string& face_values = "", const std::string& elements = "", const std::string& rest = "") {
  const auto line = [&](const char* xyz) { return xyz + (values.empty() ? "" : " " + values) + "\n"; };
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" + vertex +
         "element face 1\nproperty list uchar int vertex_indices\n" + face + elements + "end_header\n" + line("0 0 0") +
         line("1 0 0") + line("0 1 0") + "3 0 1 2" + (face_values.empty() ? "" : " " + face_values) + "\n" + rest;
}

std::string properties(std::initializer_list<const char*> names, const char* type = "float") {
  std::string text;
  for (const char* const name : names) text += fmt::format("property {} {}\n", type, name);
  return text;
}

TEST_F(Names, PropertiesOfPlyVerticesAreCarried) {
  for (const auto& names : {std::array{"nx", "ny", "nz"}, std::array{"normal_x", "normal_y", "normal_z"}}) {
    const std::string text = ply(properties({names[0], names[1], names[2]}), "0 0.6 0.8");
    EXPECT_EQ(carried("a.ply", text, "ply").normals, std::vector<glm::vec3>(3, {0, 0.6F, 0.8F}));
  }
  for (const auto& names : {std::array{"red", "green", "blue", "alpha"}, std::array{"r", "g", "b", "a"},
                            std::array{"diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"}}) {
    for (const auto& [type, values] :
         {std::pair("uchar", "51 102 153 204"), std::pair("float", "0.2 0.4 0.6 0.8"),
          std::pair("float", "51 102 153 204"), std::pair("double", "0.2 0.4 0.6 0.8"),
          std::pair("ushort", "13107 26214 39321 52428"), std::pair("int", "51 102 153 204")}) {
      const std::string text = ply(properties({names[0], names[1], names[2], names[3]}, type), values);
      EXPECT_EQ(carried("a.ply", text, "ply").colors, std::vector<glm::u8vec4>(3, {51, 102, 153, 204})) << text;
    }
  }
  for (const auto& names : {std::array{"u", "v"}, std::array{"s", "t"}, std::array{"texture_u", "texture_v"},
                            std::array{"texture_s", "texture_t"}, std::array{"s0", "t0"}, std::array{"tx", "ty"}}) {
    const std::string text = ply(properties({names[0], names[1]}), "0.25 0.75");
    EXPECT_EQ(carried("a.ply", text, "ply").texture_coordinates, std::vector<glm::vec2>(3, {0.25F, 0.75F}));
  }
}

// Alone, a part of what is used together is of no use.
TEST_F(Names, OtherPropertiesOfPlyVerticesAreCounted) {
  for (const char* const name : {"nx",
                                 "ny",
                                 "nz",
                                 "normal_x",
                                 "red",
                                 "green",
                                 "blue",
                                 "alpha",
                                 "r",
                                 "g",
                                 "b",
                                 "a",
                                 "u",
                                 "v",
                                 "s",
                                 "t",
                                 "s0",
                                 "tx",
                                 "texture_u",
                                 "diffuse_red",
                                 "diffuse_alpha",
                                 "ambient_red",
                                 "ambient_green",
                                 "specular_red",
                                 "specular_power",
                                 "opacity",
                                 "rgb",
                                 "rgba",
                                 "confidence",
                                 "intensity",
                                 "quality",
                                 "radius",
                                 "curvature",
                                 "flags",
                                 "value",
                                 "label",
                                 "class",
                                 "classification",
                                 "timestamp",
                                 "material_index",
                                 "object_id",
                                 "scalar_A b",
                                 "f_dc_0",
                                 "f_rest_0",
                                 "scale_0",
                                 "rot_0",
                                 "vx",
                                 "vy",
                                 "vz",
                                 "x0",
                                 "pxx",
                                 "tangent_x",
                                 "crease",
                                 "weight"}) {
    expect_counted("a.ply", ply(properties({name}), "0.5"), fmt::format("property {} of vertex", name), 3);
    expect_counted("a.ply", ply(fmt::format("property list uchar float {}\n", name), "2 0.5 7"),
                   fmt::format("property {} of vertex", name), 3);
  }
}

TEST_F(Names, PropertiesOfPlyFacesAreCarriedOrCounted) {
  for (const char* const name : {"nx", "ny", "nz", "red", "green", "blue", "alpha", "diffuse_red", "flags", "quality",
                                 "intensity", "material_index", "group_id", "texnumber", "area", "scalar_A b"})
    expect_counted("a.ply", ply("", "", properties({name}), "0"), fmt::format("property {} of face", name), 1);
  for (const char* const name : {"color", "rgb", "neighbours", "vertex_index", "texture_coordinates", "weights"})
    expect_counted("a.ply", ply("", "", fmt::format("property list uchar int {}\n", name), "2 7 8"),
                   fmt::format("property {} of face", name), 1);
  const std::string wedges = ply("", "", "property list uchar float texcoord\n", "6 0 0 1 0 0 1");
  EXPECT_EQ(carried("a.ply", wedges, "ply").texture_coordinates, (std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}}));
  std::string textured = ply(properties({"s", "t"}), "0 1", "property int texnumber\n", "1");
  textured.insert(textured.find("element"), "comment TextureFile a.png\ncomment TextureFile b.png\n");
  const CleanMesh mesh = folder_.read("a.ply", textured);
  EXPECT_EQ(mesh.report.left_out, LeftOut{});
  EXPECT_EQ(mesh.mesh.textures.at(mesh.mesh.materials.at(mesh.mesh.material_of(0)).texture).file, "b.png");
}

TEST_F(Names, ElementsOfPlyAreCarriedOrCounted) {
  for (const char* const name : {"edge", "material", "camera", "range_grid", "cell", "polyhedron", "trifans", "point",
                                 "multi_texture_vertex", "multi_texture_face", "user_defined", "nx"})
    expect_counted("a.ply", ply("", "", "", "", fmt::format("element {} 2\nproperty int a\n", name), "7\n8\n"),
                   fmt::format("element {}", name), 2);
  const std::string strips =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n4 0 1 2 3\n";
  EXPECT_EQ(carried("a.ply", strips, "ply").triangle_count(), 2U);
  std::string info = ply("", "");
  info.insert(info.find("element"), "obj_info a\ncomment b\nobj_info c\n");
  expect_counted("a.ply", info, "obj_info lines", 2);
  expect_counted("a.ply", ply("", "") + "3 0 2 1\n", "lines after the last element", 1);
  expect_counted("a.ply", ply("", "", "", "7 8"), "values at the ends of face lines", 2);
}

// As coordinates and indices, in text and in both byte orders.
template <class Number>
void add_triangle(test::Bytes& bytes) {
  for (const int value : {0, 0, 0, 1, 0, 0, 0, 1, 0}) bytes.add(static_cast<Number>(value));
  bytes.add(std::uint8_t{3});
  for (const int value : {0, 1, 2}) bytes.add(static_cast<Number>(value));
}

TEST_F(Names, TypesOfPlyAreRead) {
  struct Type {
    std::vector<const char*> names;
    void (*add)(test::Bytes&);
  };
  const std::vector<Type> types = {
      {{"char", "int8"}, add_triangle<std::int8_t>},    {{"uchar", "uint8"}, add_triangle<std::uint8_t>},
      {{"short", "int16"}, add_triangle<std::int16_t>}, {{"ushort", "uint16"}, add_triangle<std::uint16_t>},
      {{"int", "int32"}, add_triangle<std::int32_t>},   {{"uint", "uint32"}, add_triangle<std::uint32_t>},
      {{"int64"}, add_triangle<std::int64_t>},          {{"uint64"}, add_triangle<std::uint64_t>},
      {{"float", "float32"}, add_triangle<float>},      {{"double", "float64"}, add_triangle<double>}};
  for (const Type& type : types) {
    for (const char* const name : type.names) {
      const auto header = [&](const char* format) {
        return fmt::format(
            "ply\nformat {0} 1.0\nelement vertex 3\nproperty {1} x\nproperty {1} y\nproperty {1} z\n"
            "element face 1\nproperty list uchar {1} vertex_indices\nend_header\n",
            format, name);
      };
      test::Bytes little(header("binary_little_endian")), big(header("binary_big_endian"), std::endian::big);
      type.add(little);
      type.add(big);
      for (const std::string& text : {header("ascii") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", little.str(), big.str()})
        EXPECT_EQ(carried("a.ply", text, "ply").positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    }
  }
}

constexpr const char* triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

TEST_F(Names, KeywordsOfObjAreCarried) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(carried("a.obj", v + "fo 1 2 3\n", "obj").triangle_count(), 1U);
  EXPECT_EQ(carried("a.obj", v + "vn 0 0.6 0.8\nf 1//1 2//1 3//1\n", "obj").normals.size(), 3U);
  EXPECT_EQ(carried("a.obj", v + "vt 0 1 0\nf 1/1 2/1 3/1\n", "obj").texture_coordinates.size(), 3U);
  EXPECT_EQ(carried("a.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n", "obj").colors.size(), 3U);
  static_cast<void>(folder_.write("a.mtl",
                                  "newmtl m\nKd 0.5 0.25 1\nd 0.5\nKe 0 1 0.5\nPr 0.5\nPm 0.25\n"
                                  "map_Kd -clamp on a.png\nmap_Ke -s 2 2 -o 0.5 e.png\nnorm -clamp on n.png\n"));
  const TriangleMesh mesh = carried("a.obj", "mtllib a.mtl\nusemtl m\n" + v + "f 1 2 3\n", "obj");
  EXPECT_EQ(read_mesh(folder_.path() / "again.obj").mesh.materials, mesh.materials);
}

TEST_F(Names, OtherKeywordsOfObjAreCounted) {
  struct Line {
    const char* text;
    const char* name;
  };
  for (const Line& line :
       {Line{"o x", "unused objects (o)"}, Line{"g x", "unused groups (g)"}, Line{"s 1", "smoothing groups (s)"},
        Line{"l 1 2", "lines (l)"}, Line{"p 1", "points (p)"}, Line{"v 0 0 0 0.5", "weights of vertices (v)"},
        Line{"vt 0 0", "unused texture coordinates (vt)"}, Line{"vn 0 0 1", "unused normals (vn)"},
        Line{"mtllib no.mtl", "missing libraries (mtllib)"}, Line{"usemtl no", "undefined materials (usemtl)"}})
    expect_counted("a.obj", triangle + std::string(line.text) + "\n", line.name, 1);
  for (const char* const keyword :
       {"vp",       "cstype", "deg",        "bmat",      "step",  "curv",  "curv2",  "surf",   "parm",
        "trim",     "hole",   "scrv",       "sp",        "end",   "con",   "mg",     "bevel",  "c_interp",
        "d_interp", "lod",    "shadow_obj", "trace_obj", "ctech", "stech", "maplib", "usemap", "bsp",
        "bzp",      "cdc",    "cdp",        "res",       "call",  "csh",   "xyzzy"})
    expect_counted("a.obj", triangle + fmt::format("{} 1 2\n", keyword), fmt::format("keyword {}", keyword), 1);
  // What says nothing is no loss.
  expect_counted("a.obj", triangle + std::string("# c\ns off\ns 0\ng\n\nv 5 5 5 1\n"), "", 0);
  expect_counted("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0 1\nf 1/1 2/1 3/1\n", "third texture coordinates (vt)", 1);
  expect_counted("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1 7\nf 1//1 2//1 3//1\n", "values at the ends of lines",
                 1);
  expect_counted("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//1 3//1\n", "normal indices without vn", 3);
  expect_counted("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/1 3/1\n", "texture indices without vt", 3);
}

TEST_F(Names, KeywordsOfMtlAreCounted) {
  const auto counted = [&](const std::string& line, const std::string& name) {
    static_cast<void>(folder_.write("a.mtl", "newmtl m\n" + line + "\n"));
    expect_counted("a.obj", std::string("mtllib a.mtl\nusemtl m\n") + triangle, name, 1);
  };
  for (const char* const keyword : {"Ka",
                                    "Ks",
                                    "Km",
                                    "Kt",
                                    "Tf",
                                    "Ns",
                                    "Ni",
                                    "illum",
                                    "sharpness",
                                    "Ps",
                                    "Pc",
                                    "Pcr",
                                    "aniso",
                                    "anisor",
                                    "map_Ka",
                                    "map_Ks",
                                    "map_Ns",
                                    "map_Ni",
                                    "map_d",
                                    "map_Tr",
                                    "map_Bump",
                                    "map_bump",
                                    "bump",
                                    "disp",
                                    "map_disp",
                                    "decal",
                                    "map_decal",
                                    "refl",
                                    "map_refl",
                                    "map_aat",
                                    "map_Pr",
                                    "map_Pm",
                                    "map_Ps",
                                    "map_Pc",
                                    "map_Pcr",
                                    "map_aniso",
                                    "map_norm",
                                    "map_Kn",
                                    "map_RMA",
                                    "map_ORM",
                                    "map_occlusion",
                                    "map_emissive",
                                    "map_opacity",
                                    "xyzzy"})
    counted(fmt::format("{} 1", keyword), keyword);
  for (const char* const option : {"-blendu on", "-blendv on", "-boost 1", "-bm 1", "-cc on", "-imfchan r", "-mm 0 1",
                                   "-t 1 1 1", "-texres 1", "-type sphere"})
    counted(fmt::format("map_Kd {}", option), "map_Kd " + std::string(option).substr(0, std::string(option).find(' ')));
  counted("Kd spectral a.rfl", "Kd spectral");
  counted("Kd xyz 0 0 0", "Kd xyz");
  counted("d -halo 1", "d -halo");
  counted("Ke 2", "Ke above 1 (clamped)");
  counted("norm -bm 1 n.png", "norm -bm");
  counted("map_Ke -t 1 e.png", "map_Ke -t");
  counted("norm -s 2 n.png\nmap_Kd -s 0 a.png", "norm beside map_Kd -s 0");
  counted("newmtl m", "materials defined again (newmtl)");
  counted("newmtl other", "unused materials (newmtl)");
}

TEST_F(Names, WhatAnStlHoldsIsCarriedOrCounted) {
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  expect_counted("a.stl", "solid\n" + facet + "endsolid\n", "facet normals", 1);
  const LeftOut named = folder_.read("a.stl", "solid a\n" + facet + "endsolid a\n").report.left_out;
  EXPECT_EQ(named.count("solids"), 1U);
  for (const char* const keyword : {"solid", "facet", "outer", "vertex", "endloop", "endfacet"}) {
    std::string text = "solid\n" + facet + "endsolid\n";
    text.replace(text.find(keyword), std::string(keyword).size(), "xyzzy");
    EXPECT_NE(folder_.complaint("a.stl", text).find("xyzzy"), std::string::npos) << keyword;
  }
  const auto binary = [](const std::string& header, std::uint16_t attributes) {
    std::string text = header;
    text.resize(80, ' ');
    test::Bytes bytes(text);
    bytes.add(std::uint32_t{1}).add_point(0, 0, 1).add_point(0, 0, 0).add_point(1, 0, 0).add_point(0, 1, 0);
    return bytes.add(attributes).str();
  };
  expect_counted("a.stl", binary("binary", 0), "facet normals", 1);
  EXPECT_EQ(folder_.read("a.stl", binary("binary", 5)).report.left_out.count("facets with attribute bytes"), 1U);
  for (const char* const key : {"COLOR=", "MATERIAL="})
    EXPECT_EQ(folder_.read("a.stl", binary(key, 0)).report.left_out.count(std::string(key) + " of the header"), 1U);
  EXPECT_EQ(folder_.read("a.stl", binary("", 0) + "x").report.left_out.count("bytes after the last facet"), 1U);
}

TEST_F(Names, WhatAnOffHoldsIsCarriedOrCounted) {
  for (const bool texture : {false, true}) {
    for (const bool color : {false, true}) {
      for (const bool normal : {false, true}) {
        std::string text = std::string(texture ? "ST" : "") + (color ? "C" : "") + (normal ? "N" : "") + "OFF\n3 1 0\n";
        for (const char* const xyz : {"0 0 0", "1 0 0", "0 1 0"})
          text += std::string(xyz) + (normal ? " 0 0.6 0.8" : "") + (color ? " 51 102 153 204" : "") +
                  (texture ? " 0.25 0.75" : "") + "\n";
        const TriangleMesh mesh = carried("a.off", text + "3 0 1 2\n", "ply");
        EXPECT_EQ(mesh.normals, std::vector<glm::vec3>(normal ? 3 : 0, {0, 0.6F, 0.8F})) << text;
        EXPECT_EQ(mesh.colors, std::vector<glm::u8vec4>(color ? 3 : 0, {51, 102, 153, 204})) << text;
        EXPECT_EQ(mesh.texture_coordinates, std::vector<glm::vec2>(texture ? 3 : 0, {0.25F, 0.75F})) << text;
      }
    }
  }
  const std::string vertices = "OFF\n3 1 3\n0 0 0\n1 0 0\n0 1 0\n";
  for (const char* const color : {"7", "1 0 0", "255 0 0 255"})
    expect_counted("a.off", vertices + "3 0 1 2 " + color + "\n", "face colours", 1);
  expect_counted("a.off", vertices + "3 0 1 2\n3 0 2 1\n", "lines after the last face", 1);
  expect_counted("a.off", "OFF\n3 1 0\n0 0 0 7\n1 0 0 7\n0 1 0 7\n3 0 1 2\n", "values at the ends of vertex lines", 3);
  for (const char* const refused : {"4OFF", "nOFF", "4nOFF", "OFF BINARY"})
    EXPECT_NE(folder_.complaint("a.off", refused + std::string("\n3 1 0\n")), "accepted");
}

}  // namespace
}  // namespace occlod
