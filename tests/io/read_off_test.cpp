#include <gtest/gtest.h>

#include "io/mesh_files.h"

namespace occlod {
namespace {

class ReadOff : public testing::Test {
 protected:
  [[nodiscard]] CleanMesh read(const std::string& text) const { return folder_.read("a.off", text); }
  [[nodiscard]] std::string complaint(const std::string& text) const { return folder_.complaint("a.off", text); }

  test::TestFolder folder_;
};

TEST_F(ReadOff, HeaderMayTakeManyForms) {
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (const char* header : {"OFF\n3 1 3\n", "OFF 3 1 3\n", "OFF 3 1\n", "# c\nOFF # d\n\n# e\n3 1 0 # f\n", "3 1 0\n",
                             "OFF\r\n3 1 0\r\n", "OFF3 1 0\n", "off\n3 1 0\n", "OFF3\n1 0\n"}) {
    EXPECT_EQ(read(header + body).mesh.triangles, (std::vector<Triangle>{{0, 1, 2}})) << header;
  }
}

TEST_F(ReadOff, ReadsNormalsColoursAndTextureCoordinates) {
  const CleanMesh n = read("NOFF\n3 1 0\n0 0 0 0 0 2\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n");
  EXPECT_EQ(n.mesh.normals.at(0), glm::vec3(0, 0, 1));
  EXPECT_TRUE(n.mesh.colors.empty());
  const CleanMesh c = read("COFF\n3 1 0\n0 0 0 255 0 17\n1 0 0 0 0 0 8\n0 1 0 127.6 0 255 255\n3 0 1 2\n");
  EXPECT_EQ(c.mesh.colors.at(0), glm::u8vec4(255, 0, 17, 255));
  EXPECT_EQ(c.mesh.colors.at(1), glm::u8vec4(0, 0, 0, 8));
  EXPECT_EQ(c.mesh.colors.at(2), glm::u8vec4(128, 0, 255, 255));
  const CleanMesh all =
      read("STCNOFF\n3 1 0\n0 0 0 1 0 0 9 8 7 0.5 0.5\n1 0 0 1 0 0 9 8 7 0 0\n0 1 0 1 0 0 9 8 7 6 0 0\n3 0 1 2\n");
  EXPECT_EQ(all.mesh.normals.at(2), glm::vec3(1, 0, 0));
  EXPECT_EQ(all.mesh.colors.at(1), glm::u8vec4(9, 8, 7, 255));  // the last two numbers are texture coordinates
  EXPECT_EQ(all.mesh.colors.at(2), glm::u8vec4(9, 8, 7, 6));
  EXPECT_EQ(all.mesh.texture_coordinates, (std::vector<glm::vec2>{{0.5F, 0.5F}, {0, 0}, {0, 0}}));
  EXPECT_EQ(all.report.left_out, LeftOut{});
}

// Colours printed with %g have whole numbers and fractions: all have one scale, which the largest tells.
TEST_F(ReadOff, ScalesColoursByTheWholeFile) {
  const CleanMesh mixed = read("COFF\n3 1 0\n0 0 0 1 0 0 1\n1 0 0 0.5 0.25 0.75 1\n0 1 0 1.25 0 0 0\n3 0 1 2\n");
  EXPECT_EQ(mixed.mesh.colors, (std::vector<glm::u8vec4>{{255, 0, 0, 255}, {128, 64, 191, 255}, {255, 0, 0, 0}}));
  EXPECT_EQ(mixed.report.left_out.count("colours out of range (clamped)"), 1u);
  EXPECT_EQ(read("COFF\n3 1 0\n0 0 0 1 0 0\n1 0 0 2 0 0\n0 1 0 0 0 0\n3 0 1 2\n").mesh.colors.at(1),
            glm::u8vec4(2, 0, 0, 255));
}

// Many programs write colours without the C of the header. Other numbers behind coordinates are only counted.
TEST_F(ReadOff, ReadsColoursThatTheHeaderDoesNotName) {
  const CleanMesh colors = read("OFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 128\n0 1 0\n3 0 1 2\n");
  EXPECT_EQ(colors.mesh.colors, (std::vector<glm::u8vec4>{{255, 0, 0, 255}, {0, 255, 0, 128}, {255, 255, 255, 255}}));
  EXPECT_EQ(colors.report.left_out, LeftOut{});
  const CleanMesh other = read("OFF\n3 1 0\n0 0 0 7\n1 0 0 7 8\n0 1 0\n3 0 1 2\n3 0 2 1\n# c\n");
  EXPECT_TRUE(other.mesh.colors.empty());
  EXPECT_EQ(other.report.left_out.count("values at the ends of vertex lines"), 3u);
  EXPECT_EQ(other.report.left_out.count("lines after the last face"), 1u);
}

TEST_F(ReadOff, IgnoresFaceColoursAndComments) {
  const CleanMesh result = read("OFF\n4 2 0\n0 0 0 # a\n1 0 0\n1 1 0\n#\n0 1 0\n3 0 1 2 0.5 0 0\n3 0 2 3 255 0 0 1\n");
  EXPECT_EQ(result.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
}

TEST_F(ReadOff, NamesTheLineOfEveryFault) {
  EXPECT_CONTAINS(complaint("PLY\n"), "line 1: the header 'PLY'");
  EXPECT_CONTAINS(complaint("4OFF\n"), "line 1: the header '4OFF'");
  EXPECT_CONTAINS(complaint("OFF8x 6 0\n"), "line 1: the header 'OFF8x'");
  EXPECT_CONTAINS(complaint("# c\nOFF3 -1 0\n0 0 0\n"), "line 2: the number of faces is negative");
  EXPECT_CONTAINS(complaint("OFF BINARY\n"), "binary OFF");
  EXPECT_CONTAINS(complaint("OFF\n"), "the file ends before the number of vertices");
  EXPECT_CONTAINS(complaint("OFF\n-3 1 0\n"), "line 2: the number of vertices is negative");
  EXPECT_CONTAINS(complaint("OFF\n3 -1 0\n"), "line 2: the number of faces is negative");
  EXPECT_CONTAINS(complaint("OFF\n3.5 1 0\n"), "not a whole number");
  EXPECT_CONTAINS(complaint("OFF\n4000000000 1 0\n0 0 0\n"), "line 2: 4000000000 vertices do not fit");
  EXPECT_CONTAINS(complaint("OFF\n3 9000000000000000000 0\n0 0 0\n1 0 0\n0 1 0\n"), "faces do not fit");
  const std::string head = "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_CONTAINS(complaint("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n"), "line 4: z of a vertex is missing");
  EXPECT_CONTAINS(complaint(head), "the file ends before face 2 of 2");
  EXPECT_CONTAINS(complaint(head + "3 0 1\n"), "line 7: a corner of a face is missing");
  EXPECT_CONTAINS(complaint(head + "3 0 1 3\n"),
                  "line 7: a face uses vertex 3, but there are only 3 vertices, numbered from 0");
  EXPECT_CONTAINS(complaint(head + "3 0 1 -1\n"), "line 7: a face uses vertex -1");
  EXPECT_CONTAINS(complaint(head + "2 0 1\n"), "line 7: a face needs three corners");
  EXPECT_CONTAINS(complaint(head + "-3 0 1 2\n"), "line 7: a face needs three corners");
  EXPECT_CONTAINS(complaint(head + "3000000000 0 1 2\n"), "line 7: a corner of a face is missing");
  EXPECT_CONTAINS(complaint("OFF\n3 1 0\n0 0 0\n1 0 inf\n0 1 0\n3 0 1 2\n"), "line 4: a coordinate");
  EXPECT_CONTAINS(complaint("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"), "has no faces");
  EXPECT_CONTAINS(complaint("COFF\n3 1 0\n0 0 0 1 2\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n"), "line 3");
}

}  // namespace
}  // namespace occlod
