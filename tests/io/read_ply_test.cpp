#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "io/mesh_files.h"

namespace occlod {
namespace {

const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
const std::string faces = "property list uchar int vertex_indices\n";

std::string header(const std::string& format, const std::string& elements) {
  return "ply\nformat " + format + " 1.0\ncomment it\nobj_info it\n" + elements + "end_header\n";
}

std::string ascii_triangle(const std::string& vertex = "1 0 0", const std::string& face = "3 0 1 2") {
  return header("ascii", "element vertex 3\n" + xyz + "element face 1\n" + faces) + "0 0 0\n" + vertex + "\n0 1 0\n" +
         face + "\n";
}

class ReadPly : public testing::Test {
 protected:
  [[nodiscard]] CleanMesh read(const std::string& text) const { return folder_.read("a.ply", text); }
  [[nodiscard]] std::string complaint(const std::string& text) const { return folder_.complaint("a.ply", text); }

  test::TestFolder folder_;
};

TEST_F(ReadPly, ReadsAscii) {
  const CleanMesh result = read(ascii_triangle());
  EXPECT_EQ(result.mesh.positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(result.mesh.triangles[0], Triangle(0, 1, 2));
}

// Both byte orders, properties out of order and of many types, elements and lists to be skipped before, between and
// after.
TEST_F(ReadPly, ReadsBinaryOfEitherOrderWithAllThatMayStandInIt) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const std::string format = order == std::endian::little ? "binary_little_endian" : "binary_big_endian";
    test::Bytes bytes(header(format,
                             "element camera 2\nproperty int16 a\nproperty list ushort double b\n"
                             "element vertex 3\nproperty double z\nproperty uchar blue\nproperty list uint8 int8 l\n"
                             "property short x\nproperty uint y\nproperty uchar red\nproperty uint8 green\n"
                             "property float nx\nproperty float ny\nproperty double nz\n"
                             "element face 1\nproperty float q\nproperty list int ushort vertex_index\n"
                             "element edge 1\nproperty int v\n"),
                      order);
    bytes.add(std::int16_t{1}).add(std::uint16_t{0}).add(std::int16_t{1}).add(std::uint16_t{2}).add(1.0).add(2.0);
    for (int v = 0; v < 3; ++v) {
      bytes.add(0.1 * v).add(static_cast<std::uint8_t>(v)).add(std::uint8_t{1}).add(std::int8_t{-1});
      bytes.add(static_cast<std::int16_t>(-v)).add(std::uint32_t{v == 2 ? 70000u : 0u});
      bytes.add(std::uint8_t{255}).add(std::uint8_t{7}).add(0.0f).add(2.0f).add(0.0);
    }
    bytes.add(1.5f).add(std::int32_t{3}).add(std::uint16_t{2}).add(std::uint16_t{0}).add(std::uint16_t{1});
    bytes.add(std::int32_t{9});
    const CleanMesh result = read(bytes.str());
    EXPECT_EQ(result.mesh.positions, (std::vector<glm::vec3>{{0, 0, 0}, {-1, 0, 0.1f}, {-2, 70000, 0.2f}}));
    EXPECT_EQ(result.mesh.normals, std::vector<glm::vec3>(3, {0, 1, 0}));
    EXPECT_EQ(result.mesh.colors, (std::vector<glm::u8vec4>{{255, 7, 0, 255}, {255, 7, 1, 255}, {255, 7, 2, 255}}));
    EXPECT_EQ(result.mesh.triangles, (std::vector<Triangle>{{2, 0, 1}}));
  }
}

// A zigzag strip in a file of several blocks, with records that straddle their ends at every offset: 13 bytes a vertex
// and a face. Quads in between switch from packed triangles to polygons; each is a parallelogram, so a fan from its
// first corner.
TEST_F(ReadPly, ReadsRecordsAcrossBlocks) {
  constexpr std::uint32_t vertices = 200'000;
  for (const std::uint32_t quad_every : {0u, 90'001u}) {
    for (const std::endian order : {std::endian::little, std::endian::big}) {
      const std::string format = order == std::endian::little ? "binary_little_endian" : "binary_big_endian";
      const std::string elements = "element vertex " + std::to_string(vertices) + "\n" + xyz +
                                   "property uchar flag\nelement face " + std::to_string(vertices - 3) + "\n" + faces;
      test::Bytes bytes(header(format, elements), order);
      TriangleMesh expected;
      for (std::uint32_t v = 0; v < vertices; ++v) {
        expected.positions.emplace_back(v, v % 2, 0.0f);
        bytes.add(static_cast<float>(v)).add(static_cast<float>(v % 2)).add(0.0f).add(std::uint8_t{9});
      }
      for (std::uint32_t v = 0; v + 3 < vertices; ++v) {
        const bool is_quad = quad_every != 0 && v % quad_every == quad_every - 1;
        bytes.add(static_cast<std::uint8_t>(is_quad ? 4 : 3)).add(v).add(v + 1).add(is_quad ? v + 3 : v + 2);
        expected.triangles.emplace_back(v, v + 1, is_quad ? v + 3 : v + 2);
        if (!is_quad) continue;
        bytes.add(v + 2);
        expected.triangles.emplace_back(v, v + 3, v + 2);
      }
      // The last vertex is used by no triangle of the strip, and dropped.
      expected.positions.pop_back();
      const CleanMesh result = read(bytes.str());
      EXPECT_EQ(result.mesh.positions, expected.positions);
      EXPECT_EQ(result.mesh.triangles, expected.triangles);
      EXPECT_EQ(result.report.polygons_triangulated, quad_every == 0 ? 0u : 2u);

      const std::string whole = bytes.str();
      EXPECT_NE(complaint(whole.substr(0, whole.size() - 1)), "accepted");
    }
  }
}

// A long header makes the file take several blocks; the share never falls, and 1 announces the cleaning.
TEST_F(ReadPly, TellsHowMuchIsRead) {
  const std::string comments(3'000'000, 'c');
  std::string text = ascii_triangle();
  text.insert(text.find("comment it") + 10, comments);
  std::vector<double> shares;
  const CleanMesh result = read_mesh(folder_.write("a.ply", text), [&](double done) { shares.push_back(done); });
  EXPECT_EQ(result.mesh.triangle_count(), 1u);
  EXPECT_GE(shares.size(), 3u);  // blocks are smaller than the 3 MB
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1.0);
}

TEST_F(ReadPly, ScalesColoursByTheirType) {
  const auto first_color = [&](const std::string& type, const std::string& value) {
    const std::string colors = "property " + type + " red\nproperty " + type + " green\nproperty " + type + " blue\n";
    return read(
               header("ascii", "element vertex 3\n" + xyz + colors + "property uchar alpha\nelement face 1\n" + faces) +
               "0 0 0 " + value + " 9\n1 0 0 0 0 0 0\n0 1 0 0 0 0 0\n3 0 1 2\n")
        .mesh.colors.at(0);
  };
  EXPECT_EQ(first_color("uchar", "255 128 1"), glm::u8vec4(255, 128, 1, 9));
  EXPECT_EQ(first_color("float", "1 0.5 2"), glm::u8vec4(255, 128, 255, 9));   // 0.5 * 255 + 0.5 = 128; clamped
  EXPECT_EQ(first_color("ushort", "65535 257 0"), glm::u8vec4(255, 1, 0, 9));  // 65535 / 255 = 257
}

// Of floating-point types it is the largest value that tells, for all vertices alike: whole numbers beside fractions,
// and values a little above 1, are fractions. Alpha up to 1 may stand beside colours up to 255.
TEST_F(ReadPly, ScalesColoursOfFloatsByTheWholeFile) {
  const auto read_colors = [&](const std::string& a, const std::string& b) {
    const std::string colors = "property float red\nproperty float green\nproperty float blue\nproperty float alpha\n";
    return read(header("ascii", "element vertex 3\n" + xyz + colors + "element face 1\n" + faces) + "0 0 0 " + a +
                "\n1 0 0 " + b + "\n0 1 0 " + b + "\n3 0 1 2\n");
  };
  EXPECT_EQ(read_colors("200 100 50 255", "0 1 0 0").mesh.colors.at(0), glm::u8vec4(200, 100, 50, 255));
  EXPECT_EQ(read_colors("200 100 50 1", "0 1 0 1").mesh.colors.at(1), glm::u8vec4(0, 1, 0, 255));
  EXPECT_EQ(read_colors("1 0 0 1", "0.5 0.25 0.75 1").mesh.colors.at(0), glm::u8vec4(255, 0, 0, 255));
  const CleanMesh above = read_colors("1.002 0 0 1", "0.5 0 1 1");
  EXPECT_EQ(above.mesh.colors.at(0), glm::u8vec4(255, 0, 0, 255));
  EXPECT_EQ(above.mesh.colors.at(1), glm::u8vec4(128, 0, 255, 255));
  EXPECT_EQ(above.report.left_out.count("colours out of range (clamped)"), 1u);
  EXPECT_EQ(read_colors("1 0 0 1", "0.5 0 1 1").report.left_out.count("colours out of range (clamped)"), 0u);
}

// As other programs name them.
TEST_F(ReadPly, ReadsColoursUnderTheirUsualNames) {
  for (const auto& [red, green, blue] :
       {std::array{"red", "green", "blue"}, std::array{"r", "g", "b"},
        std::array{"diffuse_red", "diffuse_green", "diffuse_blue"}, std::array{"Red", "Green", "Blue"}}) {
    std::string colors;
    for (const char* const name : {red, green, blue}) colors += std::string("property uchar ") + name + "\n";
    const CleanMesh result = read(header("ascii", "element vertex 3\n" + xyz + colors + "element face 1\n" + faces) +
                                  "0 0 0 200 100 50\n1 0 0 200 100 50\n0 1 0 200 100 50\n3 0 1 2\n");
    EXPECT_EQ(result.mesh.colors, std::vector<glm::u8vec4>(3, {200, 100, 50, 255})) << red;
  }
}

// 64-bit integers where indices and other values stand, in both byte orders.
TEST_F(ReadPly, ReadsLongIntegers) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const std::string format = order == std::endian::little ? "binary_little_endian" : "binary_big_endian";
    test::Bytes bytes(header(format, "element vertex 3\n" + xyz + "property uint64 id\n" +
                                         "element face 1\nproperty list uchar int64 vertex_indices\n"),
                      order);
    for (std::uint64_t v = 0; v < 3; ++v) bytes.add_point(v == 1, v == 2, 0).add(~v);
    bytes.add(std::uint8_t{3}).add(std::int64_t{2}).add(std::int64_t{0}).add(std::int64_t{1});
    const CleanMesh result = read(bytes.str());
    EXPECT_EQ(result.mesh.triangles, (std::vector<Triangle>{{2, 0, 1}}));
    EXPECT_EQ(result.report.left_out.count("property id of vertex"), 3u);
  }
}

// As scalar fields are named, and as MeshLab writes colours of wedges without a line in the header.
TEST_F(ReadPly, ReadsNamesWithBlanksAndCountsValuesThatTheHeaderDoesNotName) {
  const CleanMesh result =
      read(header("ascii", "element vertex 3\n" + xyz +
                               "property float scalar_C2C distances\nproperty float scalar_C2C signed\n"
                               "element face 1\n" +
                               faces) +
           "0 0 0 1 2\n1 0 0 1 2 7\n0 1 0 1 2\n3 0 1 2 255 0 0\n\n3 0 2 1\n\n");
  EXPECT_EQ(result.mesh.triangle_count(), 1u);
  const LeftOut& left_out = result.report.left_out;
  EXPECT_EQ(left_out.count("property scalar_C2C distances of vertex"), 3u);
  EXPECT_EQ(left_out.count("property scalar_C2C signed of vertex"), 3u);
  EXPECT_EQ(left_out.count("values at the ends of vertex lines"), 1u);
  EXPECT_EQ(left_out.count("values at the ends of face lines"), 3u);
  EXPECT_EQ(left_out.count("lines after the last element"), 1u);
}

// The only list of whole numbers can be nothing else. Of two with the usual names the first counts.
TEST_F(ReadPly, FindsTheListOfCorners) {
  const auto triangles = [&](const std::string& lists, const std::string& values) {
    return read(header("ascii", "element vertex 3\n" + xyz + "element face 1\n" + lists) + "0 0 0\n1 0 0\n0 1 0\n" +
                values + "\n");
  };
  EXPECT_EQ(triangles("property list uchar float w\nproperty list uchar int corners\n", "1 9 3 0 1 2").mesh.triangles,
            (std::vector<Triangle>{{0, 1, 2}}));
  const CleanMesh two =
      triangles("property list uchar int vertex_index\nproperty list uchar int vertex_indices\n", "3 0 1 2 3 2 1 0");
  EXPECT_EQ(two.mesh.triangles, (std::vector<Triangle>{{2, 1, 0}}));
  EXPECT_EQ(two.report.left_out.count("property vertex_index of face"), 1u);
  EXPECT_CONTAINS(
      folder_.complaint("a.ply",
                        header("ascii", "element vertex 3\n" + xyz +
                                            "element face 1\nproperty list uchar int a\nproperty list uchar int b\n") +
                            "0 0 0\n1 0 0\n0 1 0\n1 0 1 0\n"),
      "no list 'vertex_indices'");
}

TEST_F(ReadPly, CountsBytesAfterTheLastElement) {
  test::Bytes bytes(header("binary_little_endian", "element vertex 3\n" + xyz + "element face 1\n" + faces));
  bytes.add_point(0, 0, 0).add_point(1, 0, 0).add_point(0, 1, 0);
  bytes.add(std::uint8_t{3}).add(0).add(1).add(2);
  EXPECT_EQ(read(bytes.str()).report.left_out.count("bytes after the last element"), 0u);
  bytes.add(std::uint8_t{3}).add(0).add(2).add(1);
  EXPECT_EQ(read(bytes.str()).report.left_out.count("bytes after the last element"), 13u);
}

TEST_F(ReadPly, FacesMayComeFirstAndLinesMayBeSpaced) {
  const CleanMesh result = read(header("ascii", " element  face\t1\n" + faces + "element vertex 3 \n" + xyz) +
                                "3 0 1 2\n\n  0 0 0  \r\n1 0 0\n\t0 1 0");
  EXPECT_EQ(result.mesh.triangles[0], Triangle(0, 1, 2));
}

TEST_F(ReadPly, CutsPolygons) {
  const CleanMesh result = read(header("ascii", "element vertex 4\n" + xyz + "element face 1\n" + faces) +
                                "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  EXPECT_EQ(result.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(result.report.polygons_read, 1u);
  EXPECT_EQ(result.report.polygons_triangulated, 1u);
  EXPECT_EQ(result.report.triangles_read, 2u);
}

TEST_F(ReadPly, NamesTheFaultOfAHeader) {
  EXPECT_CONTAINS(complaint("PLX\n"), "line 1: the file does not begin with 'ply'");
  EXPECT_CONTAINS(complaint("ply\nformat ascii 1.0\n"), "the file ends inside the header");
  EXPECT_CONTAINS(complaint("ply\nelement vertex 3\n" + xyz + "end_header\n"), "no format line");
  EXPECT_CONTAINS(complaint(header("ebcdic", "")), "line 2: the format 'ebcdic'");
  EXPECT_CONTAINS(complaint(header("ascii", "element vertex -3\n" + xyz)),
                  "line 5: the number of elements is negative");
  EXPECT_CONTAINS(complaint(header("ascii", "element vertex many\n" + xyz)),
                  "line 5: the number of elements is 'many'");
  EXPECT_CONTAINS(complaint(header("ascii", "property float x\n")), "line 5: a property comes before");
  EXPECT_CONTAINS(complaint(header("ascii", "element vertex 3\nproperty half x\n")), "line 6: the type 'half'");
  EXPECT_CONTAINS(complaint(header("ascii", "element vertex 3\nproperty float\n")), "line 6: a property has no name");
  EXPECT_CONTAINS(complaint(header("ascii", "element vertex 1\n" + xyz + "property float x\n")), "second property 'x'");
  EXPECT_CONTAINS(complaint(header("ascii", "element vertex 1\n" + xyz + "element vertex 1\n")),
                  "second element 'vertex'");
  EXPECT_CONTAINS(complaint(header("ascii", "element face 1\nproperty list float int vertex_indices\n")),
                  "not of an integer type");
  EXPECT_CONTAINS(complaint(header("ascii", "nonsense\n")), "line 5: the header line begins with 'nonsense'");
  EXPECT_CONTAINS(complaint(header("ascii", "element vertex 1\nproperty float x\n") + "0\n"),
                  "vertices lack x, y or z");
  EXPECT_CONTAINS(
      complaint(header("ascii", "element vertex 1\n" + xyz + "element face 1\nproperty int a\n") + "0 0 0\n0\n"),
      "no list 'vertex_indices'");
  EXPECT_CONTAINS(complaint(header("ascii", "element vertex 1\n" + xyz) + "0 0 0\n"), "has no faces");
}

// Counts that would take more memory than the file can fill are refused before anything is allocated; an element
// without properties takes no room and no time.
TEST_F(ReadPly, RefusesAbsurdCounts) {
  for (const char* format : {"ascii", "binary_little_endian"}) {
    EXPECT_CONTAINS(complaint(header(format, "element vertex 4000000000\n" + xyz) + "0 0 0\n"), "do not fit");
    EXPECT_CONTAINS(complaint(header(format, "element face 9000000000000000000\n" + faces) + "0 0 0\n"), "do not fit");
    EXPECT_CONTAINS(complaint(header(format, "element vertex 99999999999999999999\n" + xyz)), "out of range");
    EXPECT_CONTAINS(complaint(header(format, "element nothing 9000000000000000000\n")), "has no faces");
  }
  test::Bytes bytes(header("binary_little_endian", "element face 1\nproperty list uint int vertex_indices\n"));
  bytes.add(std::uint32_t{0xffffffff}).add(std::int32_t{0});
  EXPECT_CONTAINS(complaint(bytes.str()), "face 0, byte ");
  EXPECT_CONTAINS(complaint(ascii_triangle("1 0 0", "4294967295 0 1 2")),
                  "line 15: a value of element 'face' is missing");
}

TEST_F(ReadPly, NamesTheFaultOfABody) {
  // The header has 11 lines: ply, format, comment, obj_info, element, three properties, element, property, end_header.
  EXPECT_CONTAINS(complaint(ascii_triangle("1 0")), "line 13: a value of element 'vertex' is missing");
  EXPECT_CONTAINS(complaint(ascii_triangle("1 o 0")), "line 13: a value of element 'vertex' is 'o'");
  EXPECT_CONTAINS(complaint(ascii_triangle("1 nan 0")), "line 13: a coordinate of a vertex is NaN");
  EXPECT_CONTAINS(complaint(ascii_triangle("1 0 1e300")),
                  "line 13: a coordinate of a vertex is NaN, infinite or too large");
  EXPECT_CONTAINS(complaint(ascii_triangle("1 0 0", "3 0 1 3")), "line 15: a face uses vertex 3, but there are only 3");
  EXPECT_CONTAINS(complaint(ascii_triangle("1 0 0", "3 0 1 -1")), "line 15: a face uses vertex -1");
  EXPECT_CONTAINS(complaint(ascii_triangle("1 0 0", "3 0 1 1.5")), "line 15: a face uses vertex 1.5");
  EXPECT_CONTAINS(complaint(ascii_triangle("1 0 0", "-3 0 1 2")), "line 15: the list 'vertex_indices' has -3 entries");
  EXPECT_CONTAINS(complaint(ascii_triangle("1 0 0", "2 0 1")), "line 15: a face needs three corners");
  EXPECT_CONTAINS(complaint(ascii_triangle("1 0 0", "")), "the file ends before face 1 of 1");
}

}  // namespace
}  // namespace occlod
