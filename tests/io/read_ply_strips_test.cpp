// Triangle strips: element tristrips, as in the files of the Stanford repository.
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "io/mesh_files.h"

namespace occlod {
namespace {

const std::string six_vertices = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n";

std::string header(const std::string& format, const std::string& elements) {
  return "ply\nformat " + format + " 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n" +
         elements + "end_header\n";
}

std::string strip_elements(int count = 1, const std::string& types = "int int") {
  return "element tristrips " + std::to_string(count) + "\nproperty list " + types + " vertex_indices\n";
}

// Its header has nine lines, the vertices six: the first list stands on line 16.
std::string ascii_strips(const std::string& lists, int count = 1) {
  return header("ascii", strip_elements(count)) + six_vertices + lists + "\n";
}

// Six vertices and one list; `promised` entries where that is not their number.
std::string binary_strips(std::endian order, const std::vector<std::int32_t>& entries,
                          std::optional<std::int32_t> promised = {}) {
  const std::string format = order == std::endian::little ? "binary_little_endian" : "binary_big_endian";
  test::Bytes bytes(header(format, strip_elements()), order);
  for (int v = 0; v < 6; ++v) bytes.add_point(static_cast<float>(v % 2), static_cast<float>(v / 2), 0);
  bytes.add(promised.value_or(static_cast<std::int32_t>(entries.size())));
  for (const std::int32_t entry : entries) bytes.add(entry);
  return bytes.str();
}

class ReadPlyStrips : public testing::Test {
 protected:
  [[nodiscard]] CleanMesh read(const std::string& text) const { return folder_.read("a.ply", text); }
  [[nodiscard]] std::string complaint(const std::string& text) const { return folder_.complaint("a.ply", text); }

  test::TestFolder folder_;
};

// Triangle k of a strip has its corners k, k + 1, k + 2, where k is odd the other way round. The first strip has three
// triangles, so that the second begins where a reader that counts on would turn it.
TEST_F(ReadPlyStrips, EverySecondTriangleOfAStripIsTurned) {
  const std::vector<Triangle> expected = {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {4, 3, 5}};
  for (const std::vector<std::int32_t>& entries : {std::vector<std::int32_t>{0, 1, 2, 3, 4, -1, 4, 3, 5},
                                                   {0, 1, 2, 3, 4, -1, 4, 3, 5, -1},
                                                   {-1, 0, 1, 2, 3, 4, -1, -1, 4, 3, 5}}) {
    std::string list = std::to_string(entries.size());
    for (const std::int32_t entry : entries) list += " " + std::to_string(entry);
    const CleanMesh ascii = read(ascii_strips(list));
    EXPECT_EQ(ascii.mesh.triangles, expected) << list;
    EXPECT_EQ(ascii.report.inconsistent_edges, 0u) << list;
    EXPECT_EQ(ascii.report.polygons_read, 4u) << list;
    for (const std::endian order : {std::endian::little, std::endian::big})
      EXPECT_EQ(read(binary_strips(order, entries)).mesh.triangles, expected) << list;
  }
}

// Each list is a strip of its own, whether or not -1 ends it.
TEST_F(ReadPlyStrips, ReadsSeveralLists) {
  EXPECT_EQ(read(ascii_strips("3 0 1 2\n0\n5 2 1 3 -1 -1", 3)).mesh.triangles,
            (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}}));
}

// Strips joined by repeated corners: 0 1 2 | 2 2 1 | 1 3 is (0 1 2), four triangles with a corner twice and then, for
// an even k, (2 1 3).
TEST_F(ReadPlyStrips, CountsTheTrianglesThatOnlyJoinStrips) {
  const CleanMesh result = read(ascii_strips("7 0 1 2 2 2 1 3"));
  // k = 0: (0 1 2). 1: (1 2 2). 2: (2 2 2). 3: (2 1 2). 4: (2 1 3).
  EXPECT_EQ(result.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}}));
  EXPECT_EQ(result.report.triangles_read, 5u);
  EXPECT_EQ(result.report.repeated_index_triangles, 3u);
}

TEST_F(ReadPlyStrips, ReadsStripsBesideFacesInTheirOrder) {
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
  const CleanMesh after = read(header("ascii", faces + strip_elements()) + six_vertices + "4 2 3 5 4\n3 0 1 2\n");
  EXPECT_EQ(after.mesh.triangles, (std::vector<Triangle>{{2, 3, 5}, {2, 5, 4}, {0, 1, 2}}));
  const CleanMesh before = read(header("ascii", strip_elements() + faces) + six_vertices + "3 0 1 2\n4 2 3 5 4\n");
  EXPECT_EQ(before.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 3, 5}, {2, 5, 4}}));
  EXPECT_EQ(before.report.polygons_read, 2u);
}

TEST_F(ReadPlyStrips, OtherPropertiesMayStandBesideTheListAndItsIndicesBeUnsigned) {
  test::Bytes bytes(header("binary_little_endian",
                           "element tristrips 1\nproperty uchar a\nproperty list uint8 uint32 vertex_index\n"
                           "property list uchar float b\n"));
  for (int v = 0; v < 6; ++v) bytes.add_point(static_cast<float>(v % 2), static_cast<float>(v / 2), 0);
  bytes.add(std::uint8_t{9}).add(std::uint8_t{7});
  for (const std::uint32_t entry : {0u, 1u, 2u, 0xffffffffu, 2u, 1u, 3u}) bytes.add(entry);
  bytes.add(std::uint8_t{1}).add(1.0f);
  EXPECT_EQ(read(bytes.str()).mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}}));
}

// More entries than a block of the file holds.
TEST_F(ReadPlyStrips, ReadsStripsAcrossBlocks) {
  constexpr std::int32_t length = 600'001;
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    std::vector<std::int32_t> entries;
    std::vector<Triangle> expected;
    for (std::int32_t k = 0; k < length; ++k) entries.push_back(k % 6);
    for (std::uint32_t k = 0; k + 2 < length; ++k) {
      const std::uint32_t a = k % 6, b = (k + 1) % 6, c = (k + 2) % 6;
      expected.push_back(k % 2 == 0 ? Triangle(a, b, c) : Triangle(a, c, b));
    }
    const std::string bytes = binary_strips(order, entries);
    EXPECT_EQ(read(bytes).mesh.triangles, expected);
    EXPECT_CONTAINS(complaint(bytes.substr(0, bytes.size() - 1)), "tristrips 0, byte ");
  }
}

TEST_F(ReadPlyStrips, NamesTheFaultAndItsPlace) {
  EXPECT_EQ(complaint(ascii_strips("3 0 1 6")),
            "line 16: entry 2 of the triangle strips is vertex 6, but there are 6 vertices, numbered from 0");
  EXPECT_CONTAINS(complaint(ascii_strips("3 0 1 -2")), "line 16: entry 2 of the triangle strips is vertex -2");
  EXPECT_CONTAINS(complaint(ascii_strips("3 0 1 1.5")), "line 16: entry 2 of the triangle strips is vertex 1.5");
  EXPECT_CONTAINS(complaint(ascii_strips("3 0 1 nan")), "line 16: entry 2 of the triangle strips is vertex nan");
  EXPECT_EQ(complaint(ascii_strips("6 0 1 2 -1 3 4")),
            "line 16: the triangle strip that ends before entry 6 has 2 of at least three vertices");
  EXPECT_CONTAINS(complaint(ascii_strips("6 5 -1 0 1 2 3")),
                  "line 16: the triangle strip that ends before entry 1 has 1");
  EXPECT_CONTAINS(complaint(ascii_strips("3 0 1 2\n2 0 1", 2)), "line 17: the triangle strip that ends before entry 2");
  EXPECT_CONTAINS(complaint(ascii_strips("4 0 1 2")), "line 16: a value of element 'tristrips' is missing");
  EXPECT_CONTAINS(complaint(ascii_strips("-4 0 1 2")), "line 16: the list 'vertex_indices' has -4 entries");
  EXPECT_CONTAINS(complaint(ascii_strips("3 0 1 2", 2)), "the file ends before tristrips 2 of 2");
  EXPECT_CONTAINS(complaint(ascii_strips("1 -1")), "has no faces");
  EXPECT_CONTAINS(complaint(header("ascii", "element tristrips 1\nproperty int a\n") + six_vertices + "1\n"),
                  "header: triangle strips have no list 'vertex_indices'");
  EXPECT_CONTAINS(complaint("ply\nformat ascii 1.0\n" + strip_elements() + "end_header\n3 0 1 2\n"),
                  "line 6: entry 0 of the triangle strips is vertex 0, but there are 0 vertices");
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    // The lists begin behind the header, 72 bytes of vertices and the count; the reader stands behind the bad entry.
    const std::size_t list = binary_strips(order, {}).size();
    EXPECT_CONTAINS(complaint(binary_strips(order, {0, 1, 6})),
                    "tristrips 0, byte " + std::to_string(list + 12) + ": entry 2 of the triangle strips is vertex 6");
    EXPECT_CONTAINS(complaint(binary_strips(order, {0, 1, -1})),
                    "tristrips 0, byte " + std::to_string(list + 12) + ": the triangle strip that ends before entry 2");
    EXPECT_CONTAINS(complaint(binary_strips(order, {0, 1, 2}, 0x7fffffff)), "tristrips 0, byte ");
  }
}

}  // namespace
}  // namespace occlod
