#include <gtest/gtest.h>

#include "io/mesh_files.h"

namespace occlod {
namespace {

std::string facet(const char* a, const char* b, const char* c) {
  return std::string("facet normal 0 0 1\nouter loop\nvertex ") + a + "\nvertex " + b + "\nvertex " + c +
         "\nendloop\nendfacet\n";
}

const std::string two_facets = facet("0 0 0", "1 0 0", "1 1 0") + facet("0 0 0", "1 1 0", "0 1 0");
const std::vector<Triangle> square = {{0, 1, 2}, {0, 2, 3}};

// A square of two facets whose header begins with `name`.
std::string binary_square(std::string name, std::uint32_t count = 2) {
  name.resize(80, ' ');
  test::Bytes bytes(name);
  bytes.add(count);
  for (int i = 0; i < 2; ++i) {
    bytes.add_point(0, 0, 1).add_point(0, 0, 0);
    if (i == 0) bytes.add_point(1, 0, 0).add_point(1, 1, 0);
    if (i == 1) bytes.add_point(1, 1, 0).add_point(0, 1, 0);
    bytes.add(std::uint16_t{0x1234});
  }
  return bytes.str();
}

class ReadStl : public testing::Test {
 protected:
  [[nodiscard]] CleanMesh read(const std::string& text) const { return folder_.read("a.stl", text); }
  [[nodiscard]] std::string complaint(const std::string& text) const { return folder_.complaint("a.stl", text); }

  test::TestFolder folder_;
};

TEST_F(ReadStl, ReadsAscii) {
  const CleanMesh result = read("solid a name\n" + two_facets + "endsolid a name\n");
  EXPECT_EQ(result.mesh.triangles, square);
  EXPECT_EQ(result.report.vertices_read, 6u);
  EXPECT_EQ(result.report.vertices_welded, 2u);
}

TEST_F(ReadStl, ReadsAsciiInAnyCaseWithAnyLineEndsAndManySolids) {
  EXPECT_EQ(read("  SOLID\r\n" + facet("0 0 0", "1 0 0", "1 1 0") + "EndSolid\r\n\r\nsolid b\n" +
                 facet("0 0 0", "1 1 0", "0 1 0") + "endsolid")
                .mesh.triangles,
            square);
}

TEST_F(ReadStl, BinaryIsToldBySizeNotByItsFirstWord) {
  EXPECT_EQ(read(binary_square("binary")).mesh.triangles, square);
  EXPECT_EQ(read(binary_square("solid as many exporters write")).mesh.triangles, square);
  EXPECT_EQ(read(binary_square("binary") + "trailing bytes").mesh.triangles, square);
}

// All files of a concatenation, and what follows in one line. A second half of which the header does not know, and a
// text, are no files.
TEST_F(ReadStl, ReadsFilesOneAfterTheOther) {
  const CleanMesh three = read(binary_square("a") + binary_square("solid b") + binary_square("c"));
  EXPECT_EQ(three.report.triangles_read, 6u);
  EXPECT_EQ(three.report.left_out.count("bytes after the last facet"), 0u);
  const CleanMesh rest = read(binary_square("a") + binary_square("b") + "rest");
  EXPECT_EQ(rest.report.triangles_read, 4u);
  EXPECT_EQ(rest.report.left_out.count("bytes after the last facet"), 4u);
  const CleanMesh half = read(binary_square("a", 1));
  EXPECT_EQ(half.report.triangles_read, 1u);
  EXPECT_EQ(half.report.left_out.count("bytes after the last facet"), 50u);
  const CleanMesh cut = read(binary_square("a") + binary_square("b").substr(0, 150));
  EXPECT_EQ(cut.report.triangles_read, 2u);
  EXPECT_EQ(cut.report.left_out.count("bytes after the last facet"), 150u);
}

// As programs leave the number that write to a pipe.
TEST_F(ReadStl, CountsFacetsItselfWhereTheHeaderHasNoNumber) {
  const CleanMesh result = read(binary_square("a", 0));
  EXPECT_EQ(result.mesh.triangles, square);
  EXPECT_EQ(result.report.left_out.count("bytes after the last facet"), 0u);
  EXPECT_CONTAINS(complaint(binary_square("a", 0) + "x"), "has no faces");
}

// A text never has room for as many facets as four of its characters say.
TEST_F(ReadStl, HeadersThatBeginWithSolidMayHaveBytesBehindTheirFacets) {
  const CleanMesh result = read(binary_square("solid") + std::string(2, '\0'));
  EXPECT_EQ(result.mesh.triangles, square);
  EXPECT_EQ(result.report.left_out.count("bytes after the last facet"), 2u);
  EXPECT_CONTAINS(complaint(binary_square("solid", 3)), "byte 80: promises 3 facets, but the file has room for 2");
}

TEST_F(ReadStl, CountsColoursOfTheHeader) {
  const LeftOut counts = read(binary_square(std::string("COLOR=\x10\x20\x30\xff,MATERIAL="))).report.left_out;
  EXPECT_EQ(counts.count("COLOR= of the header"), 1u);
  EXPECT_EQ(counts.count("MATERIAL= of the header"), 1u);
}

TEST_F(ReadStl, KeepsCountOfDegenerateFacets) {
  const CleanMesh result = read("solid\n" + two_facets + facet("0 0 0", "0 0 0", "1 1 0") + "endsolid\n");
  EXPECT_EQ(result.report.repeated_index_triangles, 1u);
  EXPECT_EQ(result.mesh.triangles, square);
}

TEST_F(ReadStl, NamesThePlaceOfEveryFault) {
  EXPECT_CONTAINS(complaint("hello"), "line 1: expected 'solid', but found 'hello'");
  EXPECT_CONTAINS(complaint("solid x\n"), "the file ends before 'endsolid'");
  EXPECT_CONTAINS(complaint("solid x\nendsolid\n"), "has no faces");
  EXPECT_CONTAINS(complaint("solid x\nfacet\nvertex 0 0 0\n"), "line 3: expected 'outer', but found 'vertex'");
  EXPECT_CONTAINS(complaint("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nvertex 1 0 0\n"),
                  "line 4: z of a vertex");
  EXPECT_CONTAINS(complaint("solid\n" + facet("0 0 0", "1 0 0", "1 x 0")), "line 6: y of a vertex is 'x'");
  EXPECT_CONTAINS(complaint("solid\n" + facet("0 0 0", "1 0 0", "1 nan 0") + "endsolid"), "line 6: a coordinate");
  EXPECT_CONTAINS(complaint("solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\n"),
                  "line 3: a face needs three corners or more, but has 2");
  EXPECT_CONTAINS(complaint(binary_square("binary", 3)), "byte 80: promises 3 facets, but the file has room for 2");
  EXPECT_CONTAINS(complaint(binary_square("binary", 0xffffffffu)), "byte 80: promises 4294967295 facets");
  EXPECT_CONTAINS(complaint(binary_square("binary").substr(0, 183)), "room for 1");
  std::string nan = binary_square("binary");
  nan.replace(84 + 12 + 12, 4,
              test::Bytes().add(std::uint32_t{0x7fc00000}).str());  // x of the first facet's second corner
  EXPECT_CONTAINS(complaint(nan), "vertex 1, numbered from 0: a coordinate");
}

}  // namespace
}  // namespace occlod
