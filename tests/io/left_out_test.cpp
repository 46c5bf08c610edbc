// What a file holds beside its surface is counted, and the counts travel with the hierarchy.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/mesh_files.h"
#include "mesh/section_file.h"
#include "occlod/build_hierarchy.h"
#include "support/test_meshes.h"

namespace occlod {

std::ostream& operator<<(std::ostream& stream, const LeftOut& counts) {
  for (const LeftOut::Entry& entry : counts.entries()) stream << entry.count << " " << entry.name << ", ";
  return stream;
}

namespace {

LeftOut named(const std::vector<LeftOut::Entry>& entries) {
  LeftOut counts;
  for (const LeftOut::Entry& entry : entries) counts.add(entry.name, entry.count);
  return counts;
}

class LeftOutTest : public testing::Test {
 protected:
  [[nodiscard]] LeftOut counts(const std::string& name, const std::string& text) const {
    return folder_.read(name, text).report.left_out;
  }

  test::TestFolder folder_;
};

// Four vt lines, of which three are used. Three vn lines, of which the second and third are. Materials a, "b c" and b,
// which no library describes, as there is none; object x; groups x and y, of which y has no face.
TEST_F(LeftOutTest, OfObj) {
  const std::string text =
      "mtllib m.mtl\no x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1 0\n"
      "vn 1 0 0\nvn 0 0 1\nvn 0 1 0\ng x\nusemtl a\ns 1\nf 1/1/2 2/2/3 3/3/2\ng y\nusemtl b c\nusemtl b\t\n"
      "usemtl a\ng x\ng\nf 2 4 3\n";
  EXPECT_EQ(counts("a.obj", text), named({{"unused texture coordinates (vt)", 1},
                                          {"unused normals (vn)", 1},
                                          {"undefined materials (usemtl)", 3},
                                          {"unused groups (g)", 1},
                                          {"smoothing groups (s)", 1},
                                          {"missing libraries (mtllib)", 1}}));
}

// What vertices keep is not left out.
TEST_F(LeftOutTest, NothingOfAMeshThatIsKept) {
  EXPECT_EQ(counts("a.obj", "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nvn 0 0 1\nf 1//1 2//1 3//1\n"), LeftOut{});
  EXPECT_EQ(counts("a.off", "CNOFF\n3 1 0\n0 0 0 0 0 1 9 9 9\n1 0 0 0 0 1 9 9 9\n0 1 0 0 0 1 9 9 9\n3 0 1 2 # c\n"),
            LeftOut{});
}

TEST_F(LeftOutTest, OfPly) {
  const auto text = [](const std::string& vertex, const std::string& face, const std::string& vertex_values,
                       const std::string& face_values) {
    return "ply\nformat ascii 1.0\ncomment TextureFile a.png\ncomment of TextureFile\ncomment TextureFile b.png\n"
           "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
           vertex + "element face 1\nproperty list uchar int vertex_indices\n" + face +
           "element material 3\nproperty int a\nend_header\n0 0 0" + vertex_values + "\n1 0 0" + vertex_values +
           "\n0 1 0" + vertex_values + "\n3 0 1 2" + face_values + "\n1\n2\n3\n";
  };
  const std::string color = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const std::string normal = "property float nx\nproperty float ny\nproperty float nz\n";
  // Three elements `material` in each; textures are kept.
  EXPECT_EQ(counts("a.ply", text(color + normal, "", " 1 2 3 0 0 1", "")), named({{"element material", 3}}));
  EXPECT_EQ(counts("a.ply", text("", color + normal, "", " 1 2 3 0 0 1")), named({{"property red of face", 1},
                                                                                  {"property green of face", 1},
                                                                                  {"property blue of face", 1},
                                                                                  {"property nx of face", 1},
                                                                                  {"property ny of face", 1},
                                                                                  {"property nz of face", 1},
                                                                                  {"element material", 3}}));
  for (const auto& [u, v] : {std::pair("u", "v"), std::pair("s", "t"), std::pair("texture_u", "texture_v")}) {
    const std::string pair = std::string("property float ") + u + "\nproperty float " + v + "\n";
    EXPECT_EQ(counts("a.ply", text(pair, "", " 0 1", "")), named({{"element material", 3}}));
    // The faces' own coordinates come first.
    EXPECT_EQ(counts("a.ply", text(pair, "property list uchar float texcoord\n", " 0 1", " 6 0 0 1 0 0 1")),
              named({{"texture coordinates of vertices", 3}, {"element material", 3}}));
  }
  EXPECT_EQ(counts("a.ply", text("property float u\n", "", " 0", "")),
            named({{"property u of vertex", 3}, {"element material", 3}}));
  // As MeshLab writes wedges: three pairs, and the number of the texture.
  EXPECT_EQ(
      counts("a.ply", text("", "property list uchar float texcoord\nproperty int texnumber\n", "", " 6 0 0 1 0 0 1 0")),
      named({{"element material", 3}}));
}

TEST_F(LeftOutTest, OfOff) {
  EXPECT_EQ(counts("a.off", "STOFF\n3 1 0\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n"), LeftOut{});
  EXPECT_EQ(counts("a.off", "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2 1 0 0\n3 1 3 2\n3 0 1 3 7\n"),
            named({{"face colours", 2}}));
}

// Two facets; one of the binary file has attribute bytes.
TEST_F(LeftOutTest, OfStl) {
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  EXPECT_EQ(counts("a.stl", "solid\n" + facet + facet + "endsolid\n"), named({{"facet normals", 2}}));
  EXPECT_EQ(
      counts("a.stl", "solid one\n" + facet + "endsolid\nsolid two b\n" + facet + "endsolid\nsolid one\nendsolid\n"),
      named({{"facet normals", 2}, {"solids", 2}}));
  test::Bytes bytes(std::string(80, ' '));
  bytes.add(std::uint32_t{2});
  for (const std::uint16_t attribute : {std::uint16_t{0}, std::uint16_t{0x801f}})
    bytes.add_point(0, 0, 1).add_point(0, 0, 0).add_point(1, 0, 0).add_point(0, 1, 0).add(attribute);
  EXPECT_EQ(counts("a.stl", bytes.str()), named({{"facet normals", 2}, {"facets with attribute bytes", 1}}));
}

// One triangle mesh of two primitives with three vertices each, placed by two nodes, and a third node without a mesh.
// All attributes are the same nine floats: each placement has 2 x 3 vertices with TEXCOORD_0, three of them with
// TEXCOORD_1 and with COLOR_1 as well; COLOR_0 and TEXCOORD_0 are kept. The texture of two maps has
// no image. All other names: tests/tools/gltf_test.py.
TEST_F(LeftOutTest, OfGltf) {
  // Nine floats, 0 0 0 1 0 0 0 1 0, in base64.
  const std::string text =
      R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}], "textures": [{}],
          "nodes": [{"mesh": 0}, {"mesh": 0, "translation": [0, 0, 1]}, {}], "materials": [{}, {"normalTexture": {"index": 0}},
            {"emissiveTexture": {"index": 0}, "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}}],
          "meshes": [{"primitives": [
            {"attributes": {"POSITION": 0, "NORMAL": 0, "TEXCOORD_0": 0}, "material": 2},
            {"attributes": {"POSITION": 0, "TEXCOORD_0": 0, "TEXCOORD_1": 0, "COLOR_0": 0, "COLOR_1": 0}, "material": 0}]}],
          "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
          "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri":
            "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
  EXPECT_EQ(counts("a.gltf", text), named({{"TEXCOORD_1", 6}, {"COLOR_1", 6}, {"textures without an image", 1}}));
}

// What grep counts: vt lines that no face names.
TEST_F(LeftOutTest, OfRealMeshes) {
  OCCLOD_FIND_TEST_MESH_OR_SKIP(sponza, "scenes/sponza.obj");
  const LeftOut counts = read_mesh(sponza).report.left_out;
  EXPECT_EQ(counts.count("unused texture coordinates (vt)"), 71396u - 69013u);
}

// A hierarchy's file carries the counts; one of which nothing was left out has the bytes that it had before there were
// any: no section LEFN.
TEST_F(LeftOutTest, TravelsWithTheHierarchy) {
  const CleanMesh input = folder_.read("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\ng a\ng b\nf 1 2 3\n");
  const std::filesystem::path file = folder_.path() / "a.olod";
  write_olod(file, build_hierarchy(input.mesh), input.report);
  EXPECT_EQ(read_olod(file).report.left_out, named({{"unused texture coordinates (vt)", 1}, {"unused groups (g)", 1}}));
  EXPECT_EQ(read_olod(file).report.vertices_read, 3u);
  EXPECT_NE(test::bytes_of(file).find("LEFN"), std::string::npos);
  MeshReport report = input.report;
  report.left_out = {};
  write_olod(file, build_hierarchy(input.mesh), report);
  EXPECT_EQ(read_olod(file).report.left_out, LeftOut{});
  EXPECT_EQ(test::bytes_of(file).find("LEFN"), std::string::npos);
}

// Files may name things as they like; reports are bounded and can be printed.
TEST(LeftOut, BoundsNames) {
  LeftOut counts;
  counts.add("none", 0);
  EXPECT_TRUE(counts.empty());
  counts.add("a\nb\x7f");
  EXPECT_EQ(counts.count("a?b?"), 1u);
  counts.add(std::string(LeftOut::max_name_bytes - 1, 'x') + "\u00e4");  // a character of two bytes is not cut
  EXPECT_EQ(counts.entries()[1].name, std::string(LeftOut::max_name_bytes - 1, 'x'));
  for (std::size_t i = 0; i < 2 * LeftOut::max_names; ++i) counts.add("name " + std::to_string(i), 2);
  EXPECT_EQ(counts.entries().size(), LeftOut::max_names + 1);
  EXPECT_EQ(counts.count("name 0"), 2u);
  EXPECT_EQ(counts.count("others"), 2 * (LeftOut::max_names + 2));
  EXPECT_TRUE(std::ranges::is_sorted(counts.entries(), {}, &LeftOut::Entry::name));
}

// The section of a damaged file, whose checksum may be right, is read only if it could have been written.
class LeftOutSection : public testing::Test {
 protected:
  template <class T>
  [[nodiscard]] LeftOut read(std::string_view section, std::span<const T> content) const {
    const std::filesystem::path file = folder_.path() / "a.sections";
    sections::SectionWriter writer;
    writer.add_report({});
    writer.add(section, content);
    writer.write(file, kind);
    return sections::SectionReader(file, kind, false).read_report().left_out;
  }

  [[nodiscard]] LeftOut read_names(std::string_view text) const { return read("LEFN", std::span(text)); }

  static constexpr sections::FileKind kind{{'a'}, 1, ".a", "", "build it again"};
  test::TestFolder folder_;
};

TEST_F(LeftOutSection, IsReadAsItIsWritten) {
  EXPECT_EQ(read_names("2 a b\n18446744073709551615 c\n"), named({{"a b", 2}, {"c", ~std::uint64_t{0}}}));
  for (const std::string_view bad : {"2 b\n1 a\n", "0 a\n", "1 a", "1\n", "a\n", "01 a\n", "1 a\n1 a\n", "1 a\x01\n",
                                     "\n", "1 a\n\n", "-1 a\n", "18446744073709551616 a\n"})
    EXPECT_THROW(static_cast<void>(read_names(bad)), Error) << bad;
  EXPECT_THROW(static_cast<void>(read_names("1 " + std::string(LeftOut::max_name_bytes + 1, 'x') + "\n")), Error);
}

// Older programs wrote five counts.
TEST_F(LeftOutSection, OfOlderFiles) {
  const std::array<std::array<std::uint64_t, 5>, 1> counts{{{1, 0, 3, 4, 0}}};
  EXPECT_EQ(read("LEFT", std::span<const std::array<std::uint64_t, 5>>(counts)),
            named({{"texture coordinates", 1}, {"colours", 3}, {"materials", 4}}));
}

}  // namespace
}  // namespace occlod
